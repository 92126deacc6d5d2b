// SPDX-License-Identifier: Apache-2.0
/// Finds piles that tremble, but have come to rest, so that they can sleep.
///
/// Piles never quite rest under QuickStep: the blocks of a tower of 54 tremble with 0.5 mm/s and creep 0.1 mm in ten seconds. Objects
/// that touch each other and of which no point moved farther than kRestDistance in kRestTicks, unpushed, rest together. An object
/// that touches no other moving one is not judged: its rest is exact (rigid_world.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/geometry.h>

namespace tactus::sim {

inline constexpr std::int64_t kRestTicks = 256;
inline constexpr double kRestDistance = 20e-6;  ///< [m]

class RestWatch {
 public:
  /// Another moving object, whose corners are `reach` [m] from its centre.
  void add(const Pose& pose, double reach);

  /// Something acts on an object, so that it does not count as resting in this period.   time O(1)
  void disturb(std::size_t object) noexcept { objects_[object].disturbed = true; }
  /// Two objects touch.   pre  in the last tick of a period   time O(1), about
  void touch(std::size_t a, std::size_t b) noexcept { objects_[pile_of(b)].pile = pile_of(a); }
  /// A period ends with these poses; afterwards rests() tells its result and a new one begins.   time O(objects), no allocation
  void end_period(std::span<const Pose> poses) noexcept;
  bool rests(std::size_t object) const noexcept { return objects_[object].rests; }

 private:
  struct Watched {
    Pose before;  // at the beginning of the period
    double reach;
    std::size_t pile;  // another object of the same pile; itself: it stands for the pile
    bool disturbed = false, rests = false;
    // Of the pile that it stands for.
    std::size_t members = 0;
    bool restless = false;
  };
  std::size_t pile_of(std::size_t object) noexcept;

  std::vector<Watched> objects_;
};

}  // namespace tactus::sim
