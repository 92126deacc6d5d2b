// SPDX-License-Identifier: Apache-2.0
/// How exactly each rigid object is sent to a client: by its distance from where the client looks from. spec/44-interest.md section 1.
/// Informative: an encoder's choice, which it signals. Internal to the library.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/rigid/rigid_truth.h>
#include <tactus/scene/scene.h>

namespace tactus {

class LevelsOfDetail {
 public:
  static constexpr std::size_t kMostViewpoints = 2;

  /// pre  `scene` outlives this and has interest.   allocates one byte per object
  explicit LevelsOfDetail(const Scene& scene);

  /// Viewpoints [m] that the client looks from, kMostViewpoints at most; what is not finite does not count. Without any it is sent nothing; before the
  /// first call of all, in full.
  void set_viewpoints(std::span<const Vec3> viewpoints) noexcept;

  bool looks() const noexcept { return looks_; }  ///< set_viewpoints() was called
  std::uint8_t of(std::uint32_t object) const noexcept { return levels_[object] & 7u; }
  /// It is out of interest, as the client knows: it need not be looked at but by scan().
  bool is_left_out(std::uint32_t object) const noexcept { return levels_[object] == kLeftOut; }
  void leave_out(std::uint32_t object) noexcept { levels_[object] = kLeftOut; }
  /// By where the object is now.   time about 5 ns
  void look(std::uint32_t object, const RigidTruth& truth) noexcept;
  /// What is not looked at otherwise comes nearer and goes away, too: all objects are looked at within 200 ms after anything has moved.
  /// in   changed(object)  its level is another one.   time O(objects / 200 ms), nothing while all rests
  template <class Changed>
  void scan(const RigidTruth& truth, Changed&& changed) noexcept {
    const auto moving = scene_.moving();
    if (!truth.moved().empty()) left_ = moving.size();
    for (std::size_t n = std::min(left_, slice_); n > 0; --n, --left_) {
      const std::uint32_t object = moving[next_];
      next_ = next_ + 1 < moving.size() ? next_ + 1 : 0;
      const std::uint8_t before = of(object);
      look(object, truth);
      if (of(object) != before) changed(object);
    }
  }

 private:
  using Position = std::array<double, 3>;  // grid units
  static constexpr std::uint8_t kLeftOut = 8 + kOutOfInterest;
  std::uint8_t level_at(double square) const noexcept;

  const Scene& scene_;
  std::array<double, kOutOfInterest> limits_{};  // squares of the distances up to which the levels go
  double step_;                                  // square of the distance that a viewpoint may move before all is looked at again
  std::array<Position, kMostViewpoints> viewpoints_{}, scanned_{};
  std::size_t count_ = 0;
  bool looks_ = false;                       // set_viewpoints() was called
  std::size_t slice_, left_ = 0, next_ = 0;  // objects of a tick; that are still to be looked at; index of the next
  std::vector<std::uint8_t> levels_;         // by object
};

}  // namespace tactus
