// SPDX-License-Identifier: Apache-2.0
/// A cube that a device drives, and the path of the device.
#pragma once

#include <cmath>
#include <functional>
#include <memory>

#include <tactus/base/geometry.h>
#include <tactus/rigid/device_path.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/scene/scene_builder.h>

namespace tactus::testing {

inline constexpr double kMass = 0.15, kSide = 0.04, kPush = 630, kHold = 68, kProxyFriction = 0.5, kGround = 0.7, kWeight = 9.81;
inline constexpr double kInertia = kMass * kSide * kSide / 6, kLoss = 1e-3;  // of velocities per tick

inline DrivenPhysics cube_physics() {
  return {.mass = kMass,
          .inertia = {kInertia, kInertia, kInertia},
          .stiffness = kPush,
          .hold = kHold,
          .friction = kProxyFriction,
          .damping = 1000 * kLoss};
}

inline SharedScene driven_scene(std::uint8_t dof = Dof::all, const Vec3& gravity = {0, 0, -kWeight}) {
  SceneBuilder builder;
  builder.rigid("cube", {}, {.dof = dof, .driven = cube_physics()}).motion({gravity, kGround}).baselines(64);
  return builder.build().value();
}

inline RigidState device_state(const Scene& scene, std::int64_t tick, const Vec3& position, const Vec3& velocity = {}) {
  return to_grid({{position, {}}, velocity, {}}, tick, scene.grid).value();
}

/// A packet of the device in every tick, which takes effect at once.
inline std::shared_ptr<DevicePath> path_along(const SharedScene& scene, std::int64_t ticks,
                                              const std::function<Vec3(std::int64_t)>& position) {
  auto path = std::make_shared<DevicePath>(device_scene(*scene).value());
  path->shift(0, 0);
  for (std::int64_t tick = 0; tick < ticks; ++tick)
    path->add(static_cast<std::uint64_t>(tick) + 1, device_state(*scene, tick, position(tick)));
  return path;
}

inline std::int32_t on_grid(double value, int exponent) {
  return static_cast<std::int32_t>(std::lround(std::ldexp(value, exponent)));
}

inline DrivenContact contact_at(const Vec3& point, const Vec3& normal, double drag = 0) {
  return {.is_held = false,
          .point = {on_grid(point.x, 13), on_grid(point.y, 13), on_grid(point.z, 13)},
          .normal = {on_grid(normal.x, 10), on_grid(normal.y, 10), on_grid(normal.z, 10)},
          .drag = on_grid(drag, 4)};
}
inline DrivenContact held_at(const Vec3& point) {
  return {.is_held = true, .point = {on_grid(point.x, 13), on_grid(point.y, 13), on_grid(point.z, 13)}};
}

inline RigidState driven_state(const Scene& scene, const RigidSample& sample, const DrivenContact& contact,
                               std::int64_t tick = 0) {
  RigidState out = to_grid(sample, tick, scene.grid).value();
  out.predictor = Predictor::driven;
  out.contact = contact;
  return out;
}

}  // namespace tactus::testing
