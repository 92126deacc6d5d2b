// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_predictor.h>

#include <algorithm>

#include <tactus/base/fixed.h>

namespace tactus {
namespace {

/// Half the angle turned in `dt` ticks, 2^32 to the full circle, and the axis. spec 40-rigid 4
struct Turn {
  Vec3i axis{};
  std::uint32_t half = 0;
};

Turn turn_of(const Vec3i& angular_velocity, std::int64_t dt, std::uint32_t tick_rate, unsigned exponent) noexcept {
  std::int64_t square = 0;
  for (const std::int32_t c : angular_velocity) square += static_cast<std::int64_t>(c) * c;
  const std::int64_t speed = isqrt(static_cast<std::uint64_t>(square) << 10);  // x 2^-(exponent + 5) rad/s
  if (speed == 0) return {};
  constexpr std::uint64_t kTurnPerHalfRadian = 341782638;  // 2^32 / (4 pi)
  const auto angle = static_cast<std::uint64_t>(round_div(speed * dt, tick_rate));
  Turn turn;
  turn.half = static_cast<std::uint32_t>((angle * kTurnPerHalfRadian + (std::uint64_t{1} << (exponent + 4))) >> (exponent + 5));
  for (std::size_t i = 0; i < 3; ++i) {
    turn.axis[i] = static_cast<std::int32_t>(round_div(static_cast<std::int64_t>(angular_velocity[i]) << 35, speed));
  }
  return turn;
}

}  // namespace

RigidPose RigidPredictor::pose(const RigidState& state, std::int64_t tick) const noexcept {
  const std::int64_t dt = std::min<std::int64_t>(tick - state.tick, scene_.max_extrapolation);
  RigidPose pose{state.position, state.rotation};
  if (dt == 0) return pose;
  const unsigned shift = static_cast<unsigned>(scene_.grid.position - scene_.grid.velocity);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t moved = round_div((state.velocity[i] * dt) << shift, scene_.tick_rate);
    pose.position[i] = saturate32(state.position[i] + moved);
  }
  const Turn turn = turn_of(state.angular_velocity, dt, scene_.tick_rate, scene_.grid.angular_velocity);
  if (turn.half != 0) pose.rotation = renormalise(multiply(axis_turn(turn.axis, turn.half), state.rotation));
  return pose;
}

RigidMotion RigidPredictor::motion(const RigidState& state, std::int64_t tick, const PoseError& error) const noexcept {
  RigidMotion out{state.velocity, state.angular_velocity};
  const std::int64_t dt = tick - state.tick;
  if (dt == 0) return out;
  const std::int64_t moved = (2 * dt) << (scene_.grid.position - scene_.grid.velocity);
  const std::int64_t turned = dt << (scene_.grid.rotation - scene_.grid.angular_velocity);  // the error is a quarter of the angle
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t x = error.position[i], r = error.rotation[i];
    if (x != 0) out.velocity[i] = saturate32(out.velocity[i] + round_div(3 * x * scene_.tick_rate, moved));
    if (r != 0) out.angular_velocity[i] = saturate32(out.angular_velocity[i] + round_div(6 * r * scene_.tick_rate, turned));
  }
  return out;
}

}  // namespace tactus
