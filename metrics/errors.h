// SPDX-License-Identifier: Apache-2.0
/// Errors of the rigid objects and forces at a client.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tactus/rigid/trigger.h>
#include <tactus/trace/frame.h>

namespace tactus {

/// One kind of error over time. Samples are added tick by tick; a tick counts as over if any of its samples exceeds its bound.
class ErrorSeries {
 public:
  void add(double error, bool over) noexcept;
  /// pre  `tick` is larger than the last
  void end_tick(std::int64_t tick) noexcept;

  std::uint64_t ticks() const noexcept { return ticks_; }  ///< with at least one sample
  std::uint64_t ticks_over() const noexcept { return ticks_over_; }
  /// [ticks] Longest run of violating ticks, from its first to its last, with ticks missing in between; any other tick ends it.
  std::uint64_t longest_run() const noexcept { return longest_run_; }
  double rms() const noexcept;
  double max() const noexcept { return max_; }

 private:
  std::uint64_t samples_ = 0, ticks_ = 0, ticks_over_ = 0, longest_run_ = 0;
  TickSpan run_;
  double square_sum_ = 0, max_ = 0;
  bool sampled_ = false, over_ = false;  // in this tick
};

/// Compares a replica with the truth. Objects that cannot move and forces without contact are left out.
/// The force error is that of the contact itself: the normal force at the shown pose against that at the true pose (contact_force).
class ErrorMetrics {
 public:
  ErrorMetrics(const TraceInfo& info, const RigidTriggers& bounds);

  /// in   shown  one pose per object
  ///      levels  their levels of detail, as in Replica::lod: an error counts as a 2^level-th of itself, none of what is out of interest;
  ///              empty: the scene has no interest
  /// time O(objects + users), no allocation.
  void add(const TraceFrame& truth, std::span<const Pose> shown, std::span<const std::uint8_t> levels = {}) noexcept;
  /// Also compare the force rendered at the client with the server's (closed loop only).
  void add_rendered(const TraceFrame& truth) noexcept;

  const RigidTriggers& bounds() const noexcept { return bounds_; }
  const ErrorSeries& position() const noexcept { return position_; }    ///< [m] against visual_position
  const ErrorSeries& rotation() const noexcept { return rotation_; }    ///< [rad] against visual_rotation
  const ErrorSeries& force() const noexcept { return force_; }          ///< [N] against the haptic rule
  const ErrorSeries& perceived() const noexcept { return perceived_; }  ///< the same errors against weber_fraction_at
  const ErrorSeries& rendered() const noexcept { return rendered_; }    ///< [N] at the hand, against weber_fraction_at
  double worst_haptic_ratio() const noexcept { return worst_ratio_; }   ///< largest haptic_ratio; <= 1: the rule held
  /// Names of users whose forces no contact explains in any tick: no bound of force holds for them.
  std::vector<std::string> unbound_users() const;

 private:
  bool breaks_rule(const Pose& truth, const Pose& shown, const Vec3& force, const Vec3& estimate) noexcept;
  bool is_perceptible(double force, double error) const noexcept;

  RigidTriggers bounds_;
  std::vector<std::uint32_t> moving_;
  struct User {
    std::string name;
    bool has_force = false, has_contact = false;
  };
  std::vector<User> users_;
  ErrorSeries position_, rotation_, force_, perceived_, rendered_;
  double worst_ratio_ = 0;
};

}  // namespace tactus
