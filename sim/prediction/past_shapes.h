// SPDX-License-Identifier: Apache-2.0
/// Shapes of a client's own simulation of a deformable object, and what the server's shapes say of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tactus::sim {

class PastShapes {
 public:
  using Displacement = std::array<std::int32_t, 3>;
  static constexpr unsigned kExp = 20;  ///< shapes are shown in steps of 2^-kExp m

  /// in   ticks   how far back shapes are kept
  ///      period  [ticks] from shape to shape
  PastShapes(std::size_t vertices, double ticks, double period);

  /// A new shape of the own simulation.   in  displacements  V x 3 [m]   time O(V), no allocation
  void add(std::int64_t tick, std::span<const float> displacements) noexcept;
  /// The server's newest shape, until compare().   in  displacements  [2^-position_exp m]   time O(V), no allocation
  void hear(std::span<const Displacement> displacements, unsigned position_exp, double age) noexcept;
  /// [ticks] age of a shape that was heard and not compared; none: negative
  double heard_age() const noexcept { return age_; }
  /// Compare what was heard with the own shape of that tick, between those before and after it; forget it.
  /// in   share  of the difference that is taken over
  /// time O(V), no allocation
  void compare(double tick, double share) noexcept;
  /// The own newest shape and what the server's add to it.   time O(V), no allocation
  void show() noexcept;
  /// Instead: what was heard, as it is.
  void show_heard() noexcept;
  std::span<const Displacement> shown() const noexcept { return shown_; }
  std::int64_t newest() const noexcept { return ticks_[next_]; }  ///< tick of the own newest shape

 private:
  const float* back(std::size_t i) const noexcept {
    return shapes_.data() + ((next_ + ticks_.size() - i) % ticks_.size()) * size_;
  }
  std::int64_t tick_back(std::size_t i) const noexcept { return ticks_[(next_ + ticks_.size() - i) % ticks_.size()]; }

  std::size_t size_;                 // 3 V
  double period_;                    // [ticks]
  std::vector<std::int64_t> ticks_;  // of the own shapes
  std::vector<float> shapes_;        // [m] ring
  std::size_t next_ = 0;             // the newest
  std::vector<float> offset_;        // [m] mean of server's - own
  std::vector<float> heard_;         // [m]
  std::vector<Displacement> shown_;
  double age_ = -1;
};

}  // namespace tactus::sim
