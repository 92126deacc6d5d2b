// SPDX-License-Identifier: Apache-2.0
/// The share of its bounds that a small error of an object's pose takes, to first order: by it an encoder looks ahead. Internal to the
/// library; the bounds themselves are checked without it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <tactus/rigid/contact.h>
#include <tactus/rigid/trigger.h>

namespace tactus {

class ErrorShare {
 public:
  static constexpr std::size_t kMostContacts = 8;  ///< of the object; those after them are not looked at

  /// in  triggers  widened;  truth  pose of the object;  sinking  ForceTrend, of all its contacts
  /// time O(contacts), about 30 ns for each of the object's
  ErrorShare(std::uint32_t object, const Pose& truth, std::span<const Contact> contacts, const RigidTriggers& triggers,
             double sinking = 0) noexcept;

  /// in   moved  [m], turned  [rad] from the true pose to the shown one, world frame;  later  [s] from now
  /// out  1: as large as is permitted then.   time about 20 ns
  double operator()(const Vec3& moved, const Vec3& turned, double later = 0) const noexcept;

 private:
  struct Touch {
    Vec3 lever;         // [m] from the object's origin to the point of contact, world frame
    Vec3 normal;        // zero: all directions count
    double depth;       // [m] of the probe below the face: what a tilt of the face turns
    double per_metre;   // share per metre of error at the point
    double least;       // what a force that sinks leaves of what is permitted
    double per_radian;  // share per radian of the object
  };

  double per_metre_, per_radian_, sinking_;
  std::array<Touch, kMostContacts> touches_;
  std::size_t count_ = 0;
};

}  // namespace tactus
