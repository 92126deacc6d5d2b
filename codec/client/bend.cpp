// SPDX-License-Identifier: Apache-2.0
#include <tactus/client/bend.h>

#include <algorithm>

#include <tactus/base/fixed.h>

namespace tactus {
namespace {

/// Weights of a cubic at a share of the way, x 2^-30: of the error at the end, and of the difference of velocities.
struct Weights {
  std::int64_t straight, error, motion;
};

Weights weights(std::int64_t part, std::int64_t whole) noexcept {
  const std::int64_t u = round_div(part << 30, whole);
  const std::int64_t u2 = round_shift(u * u, 30), u3 = round_shift(u2 * u, 30);
  return {u, 3 * u2 - 2 * u3, u3 - u2};
}

/// Half the angle of a rotation times its axis, 2^32 to the full circle.
Vec3i half_vector(Quat30 turn) noexcept {
  if (turn[0] < 0) turn = {-turn[0], -turn[1], -turn[2], -turn[3]};
  std::int64_t square = 0;
  for (std::size_t i = 1; i < 4; ++i) square += static_cast<std::int64_t>(turn[i]) * turn[i];
  const std::int64_t sine = isqrt(static_cast<std::uint64_t>(square));
  if (sine == 0) return {};
  const std::int64_t half = asin30(static_cast<std::int32_t>(std::min<std::int64_t>(sine, kOne30)));
  Vec3i out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = static_cast<std::int32_t>(round_div(turn[i + 1] * half, sine));
  return out;
}

/// The rotation of a half_vector().
Quat30 turned(const Vec3i& half, const Quat30& from) noexcept {
  std::uint64_t square = 0;
  for (const std::int32_t c : half) square += static_cast<std::uint64_t>(static_cast<std::int64_t>(c) * c);
  const std::int64_t length = isqrt(square);
  if (length == 0) return from;
  Vec3i axis{};
  for (std::size_t i = 0; i < 3; ++i)
    axis[i] = static_cast<std::int32_t>(round_div(static_cast<std::int64_t>(half[i]) << 30, length));
  return renormalise(multiply(axis_turn(axis, static_cast<std::uint32_t>(length)), from));
}

}  // namespace

RigidPose bend(const Scene& scene, const RigidState& a, const RigidState& b, std::int64_t tick) noexcept {
  constexpr std::int64_t kTurnPerHalfRadian = 341782638;  // 2^32 / (4 pi)
  const RigidPredictor predictor(scene);
  const std::int64_t whole = b.tick - a.tick;
  const Weights w = weights(tick - a.tick, whole);
  const RigidPose end = predictor.pose(a, b.tick);
  const RigidMotion last = predictor.motion(a, b.tick, {});
  RigidPose out = predictor.pose(a, tick);
  const auto shift = static_cast<unsigned>(scene.grid.position - scene.grid.velocity);
  const std::int64_t moved = a.velocity == Vec3i{} && b.velocity == Vec3i{} ? w.straight : w.error;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t error = saturate32(std::int64_t{b.position[i]} - end.position[i]);
    const std::int64_t change = saturate32(std::int64_t{b.velocity[i]} - last.velocity[i]);
    const std::int64_t motion = saturate32(round_div((change * whole) << shift, scene.tick_rate));
    out.position[i] = saturate32(out.position[i] + round_shift(moved * error + w.motion * motion, 30));
  }
  const std::int64_t spun = a.angular_velocity == Vec3i{} && b.angular_velocity == Vec3i{} ? w.straight : w.error;
  const Vec3i error = half_vector(multiply(b.rotation, conjugate(end.rotation)));
  Vec3i half{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t change = std::int64_t{b.angular_velocity[i]} - last.angular_velocity[i];
    const std::int64_t radians = round_div(change * whole, scene.tick_rate);
    const std::int64_t motion = saturate32(round_shift(radians * kTurnPerHalfRadian, scene.grid.angular_velocity));
    half[i] = static_cast<std::int32_t>(round_shift(spun * error[i] + w.motion * motion, 30));
  }
  out.rotation = turned(half, out.rotation);
  return out;
}

}  // namespace tactus
