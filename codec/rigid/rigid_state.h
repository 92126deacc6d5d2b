// SPDX-License-Identifier: Apache-2.0
/// The state of rigid objects at both ends, and its conversion from and to SI units. spec/40-rigid.md section 1.
#pragma once

#include <array>
#include <cstdint>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/scene/scene.h>

namespace tactus {

/// Pose and motion of one rigid object in SI units, as a simulation or a recording gives it.
struct RigidSample {
  Pose pose;
  Vec3 velocity;          ///< [m/s] world frame
  Vec3 angular_velocity;  ///< [rad/s] world frame
};

/// How an object moves until its next update, dt after it; after the scene's max_extrapolation it stands. Values are wire values, of
/// kPredictorBits. spec/40-rigid.md section 4; what each needs and does: rigid_predictor.cpp
enum class Predictor : std::uint8_t {
  linear = 0,     ///< constant velocities: x + v dt, exp(w dt / 2) q
  ballistic = 1,  ///< gravity accelerates the position: x + v dt + g dt^2 / 2
  slide = 2,      ///< both velocities fall to 0 together, v by a constant deceleration a: dt - dt^2 / (2 |v| / a) for dt
  driven = 3,     ///< the device of the client pushes or holds it; for who does not know the device, constant velocities
};
inline constexpr unsigned kPredictorBits = 2;
/// What an object that no device touches may follow instead of constant velocities.
inline constexpr std::array kFreePredictors{Predictor::ballistic, Predictor::slide};

/// Where the device of a client touches an object, in the object's frame. spec/42-driven.md section 3
struct DrivenContact {
  static constexpr int kPoint = 13, kNormal = 10, kDrag = 4;  ///< exponents of the grids
  bool is_held = false;                                       ///< coupled to `point`; else the proxy lies on a face through it
  std::array<std::int32_t, 3> point{};                        ///< x 2^-13 m
  std::array<std::int32_t, 3> normal{};                       ///< x 2^-10, outward; 0 if it is held
  std::int32_t drag = 0;  ///< x 2^-4 m/s^2: what slows down the object that is pushed, besides its weight; 0 if it is held
  friend bool operator==(const DrivenContact&, const DrivenContact&) = default;
};

/// Level of detail of an object that is not sent to the client. spec/44-interest.md section 1
inline constexpr std::uint8_t kOutOfInterest = 7;

/// Integer pose and motion of one rigid object at one tick. This is all that a decoder keeps per object.
struct RigidState {
  std::int64_t tick = 0;
  std::array<std::int32_t, 3> position{};                  ///< x 2^-position m
  std::array<std::int32_t, 4> rotation{1 << 30, 0, 0, 0};  ///< x 2^-30, Hamilton w, x, y, z
  std::array<std::int32_t, 3> velocity{};                  ///< x 2^-velocity m/s
  std::array<std::int32_t, 3> angular_velocity{};          ///< x 2^-angular_velocity rad/s, world frame
  Predictor predictor = Predictor::linear;
  std::uint8_t smoothing_exp = 0;  ///< clients pass over to this path within 2^smoothing_exp ticks; 0: at once (curve.h)
  std::uint8_t retained = 0;       ///< ... and begin with 16, 15, 12 or 8 sixteenths of what they were off it
  std::uint8_t lod = 0;            ///< level of detail: bounds are 2^lod times as wide; kOutOfInterest: none holds
  DrivenContact contact{};         ///< of the newest update that was driven
  friend bool operator==(const RigidState&, const RigidState&) = default;
};

inline constexpr std::int32_t kAngularVelocityLimit = 1 << 25;

/// At rest where the scene declares it.
inline RigidState initial_state(const Scene& scene, std::size_t object) noexcept {
  const RigidPose& initial = scene.objects[object].initial;
  return {.position = initial.position, .rotation = initial.rotation, .lod = scene.interest ? kOutOfInterest : std::uint8_t{0}};
}

/// SI sample to grid.
/// err  invalid_argument R-API-1 a component is NaN or infinite; R-API-2 the value leaves the grid's range;
///      R-API-3 the quaternion's length differs from 1 by more than 1e-3.
Result<RigidState> to_grid(const RigidSample& sample, std::int64_t tick, const GridExponents& grid) noexcept;

}  // namespace tactus
