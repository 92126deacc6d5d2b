// SPDX-License-Identifier: Apache-2.0
/// Finds piles that are at rest except for solver jitter, so that they can sleep.
///
/// Piles never come fully to rest under QuickStep: the blocks of a tower of 54 jitter with 0.5 mm/s and creep 0.1 mm in ten
/// seconds. A group of touching objects rests if none was pushed and none of their points moved farther than kRestDistance in
/// kRestTicks. An object that touches no other moving one is not judged: its rest is exact (rigid_world.h).
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
  /// Add a moving object whose corners are `reach` [m] from its centre.
  void add(const Pose& pose, double reach);

  /// Report that something acts on an object: it does not count as resting in this period.   time O(1)
  void disturb(std::size_t object) noexcept { objects_[object].disturbed = true; }
  /// Report that two objects touch.   pre  in the last tick of a period   time O(1), about
  void touch(std::size_t a, std::size_t b) noexcept { objects_[pile_of(b)].pile = pile_of(a); }
  /// End a period with these poses and begin a new one; rests() then gives the result.   time O(objects), no allocation
  void end_period(std::span<const Pose> poses) noexcept;
  bool rests(std::size_t object) const noexcept { return objects_[object].rests; }

 private:
  struct Watched {
    Pose before;  // at the beginning of the period
    double reach;
    std::size_t pile;  // another object of the same pile; itself: it represents the pile
    bool disturbed = false, rests = false;
    // Of the pile that it represents.
    std::size_t members = 0;
    bool restless = false;
  };
  std::size_t pile_of(std::size_t object) noexcept;

  std::vector<Watched> objects_;
};

}  // namespace tactus::sim
