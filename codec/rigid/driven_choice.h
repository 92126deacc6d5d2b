// SPDX-License-Identifier: Apache-2.0
/// What an update would tell of the device that drives an object: where it touches, and the drag that explains how the object moved of late.
/// spec/40-rigid.md section 4.1. Informative: an encoder's choice, which no bound depends on. Internal to the library.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/fixed.h>
#include <tactus/rigid/contact.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/scene/scene.h>

namespace tactus {

class DevicePath;

class DrivenChoice {
 public:
  /// pre  `scene` and `path` outlive this, and the scene has driven objects.   allocates
  DrivenChoice(const Scene& scene, const DevicePath& path);

  /// Write the contact of each object into `truth`; none where no device drives it, or one that is not that of the path.
  /// time O(moving objects + contacts), 0.1 us each; no allocation
  void read(std::int64_t tick, std::span<const RigidSample> samples, std::span<const Contact> contacts,
            std::span<RigidState> truth) noexcept;

 private:
  static constexpr std::size_t kWindow = 4;  // ticks over which the drag is looked at

  /// One tick of an object that is pushed.
  struct Moment {
    std::int64_t tick = -1;
    Vec3 velocity, angular;  // world and object frame
    Vec3 pull;               // acceleration by the device, world frame
    Vec3 arm;                // of the point that it acts on, world frame
  };

  const Contact* own_contact(std::uint32_t object, std::span<const Contact> contacts, const Vec3i& device) const noexcept;
  double drag_of(std::uint32_t object, const RigidSample& now, const Vec3& rounding) const noexcept;

  const Scene& scene_;
  const DevicePath& path_;
  Vec3 gravity_;                 // [m/s^2]
  std::vector<Moment> moments_;  // kWindow + 1 per object, a ring by tick
};

}  // namespace tactus
