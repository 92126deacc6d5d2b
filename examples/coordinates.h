// SPDX-License-Identifier: Apache-2.0
/// Poses of engines as poses of Tactus (metres, right-handed, z up, quaternions w x y z, double) and back. Copy it into your project; add your
/// own engine as one more line. examples/engine_world.cpp uses and checks it.
#pragma once

#include <array>
#include <cmath>

#include <tactus/base/geometry.h>

/// Here x points to the right, y forward, z up. What an engine has in their place:
struct EngineAxes {
  std::array<int, 3> axis;     // which of the engine's axes is right, forward, up
  std::array<double, 3> sign;  // and whether it points the other way
  double metres;               // of a unit of length
  double hand;                 // 1 right-handed, -1 left-handed: a rotation turns the other way in a mirror
};

inline constexpr EngineAxes kUnity{{0, 2, 1}, {1, 1, 1}, 1.0, -1};    // x right, y up, z forward
inline constexpr EngineAxes kUnreal{{1, 0, 2}, {1, 1, 1}, 0.01, -1};  // x forward, y right, z up, centimetres
inline constexpr EngineAxes kGodot{{0, 2, 1}, {1, -1, 1}, 1.0, 1};    // x right, y up, z backward

using Float3 = std::array<float, 3>;
struct EnginePose {
  Float3 position{};
  std::array<float, 4> rotation{0, 0, 0, 1};  // x y z w
};

/// A direction, a position or a velocity, in units of the engine.
inline tactus::Vec3 from_engine(const EngineAxes& e, const Float3& v) {
  const auto part = [&](std::size_t i) { return e.metres * e.sign[i] * double{v[static_cast<std::size_t>(e.axis[i])]}; };
  return {part(0), part(1), part(2)};
}
inline Float3 to_engine(const EngineAxes& e, const tactus::Vec3& v) {
  Float3 out{};
  const std::array<double, 3> parts{v.x, v.y, v.z};
  for (std::size_t i = 0; i < 3; ++i)
    out[static_cast<std::size_t>(e.axis[i])] = static_cast<float>(e.sign[i] * parts[i] / e.metres);
  return out;
}
/// [rad/s] It turns about an axis, which has no unit of length, and turns the other way in a mirror.
inline tactus::Vec3 angular_from_engine(const EngineAxes& e, const Float3& w) { return (e.hand / e.metres) * from_engine(e, w); }

/// A quaternion of floats is of length 1 but for 1e-7; it is made exact here, as Tactus wants it within 1e-3.
inline tactus::Pose pose_from_engine(const EngineAxes& e, const EnginePose& pose) {
  const auto& q = pose.rotation;
  const tactus::Vec3 v = angular_from_engine(e, {q[0], q[1], q[2]});
  const double length = std::sqrt(tactus::dot(v, v) + double{q[3]} * double{q[3]});
  return {from_engine(e, pose.position), {double{q[3]} / length, v.x / length, v.y / length, v.z / length}};
}
inline EnginePose pose_to_engine(const EngineAxes& e, const tactus::Pose& pose) {
  const Float3 v = to_engine(e, (e.hand * e.metres) * tactus::Vec3{pose.rotation.x, pose.rotation.y, pose.rotation.z});
  return {to_engine(e, pose.position), {v[0], v[1], v[2], static_cast<float>(pose.rotation.w)}};
}
