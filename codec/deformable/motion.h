// SPDX-License-Identifier: Apache-2.0
/// Temporal prediction of a few channels, each from its own past: recursive least squares with two coefficients on their
/// increments.
/// spec/50-deformable.md section 6. Integers only; part of the state that packets build on.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tactus {

class ModeMotion {
 public:
  static constexpr std::uint32_t kMaxSteps = 8;  ///< after so many frames without a packet the motion stops

  ModeMotion() = default;
  explicit ModeMotion(std::size_t channels) : channels_(channels) {}

  std::size_t size() const noexcept { return channels_.size(); }

  /// Sum of the next `steps` increments of every channel; beyond kMaxSteps there are none.   pre  out.size() == size()
  void predict(std::uint32_t steps, std::span<std::int32_t> out) const noexcept;
  /// Learn the increments of a packet that lies `steps` frames after its baseline.
  void update(std::uint32_t steps, std::span<const std::int32_t> increments) noexcept;

  /// Everything a later prediction depends on, for the state hash.
  template <class Hash>
  void add_to(Hash& hash) const noexcept {
    for (const Channel& c : channels_) {
      hash.add32(c.last);
      hash.add32(c.before);
      for (const std::int64_t s : c.correlations) hash.add64(static_cast<std::uint64_t>(s));
    }
  }

 private:
  struct Channel {
    std::int32_t last = 0, before = 0;           // increments per frame
    std::array<std::int64_t, 5> correlations{};  // fading correlations of products: 11, 12, 22, 01, 02; 0 now, 1 last, 2 before
  };
  std::vector<Channel> channels_;
};

}  // namespace tactus
