// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid.h>

#include <cmath>

#include <tactus/base/fixed.h>
#include <tactus/base/hash.h>

namespace tactus {
namespace {

constexpr std::int32_t kSpinLimit = 1 << 25;

/// Half the angle turned in `dt` ticks, 2^32 to the full circle, and the axis. spec 40-rigid 4
struct Turn {
  Vec3i axis{};
  std::uint32_t half = 0;
};

Turn turn_of(const Vec3i& spin, std::int64_t dt, std::uint32_t tick_rate, unsigned exponent) noexcept {
  std::int64_t square = 0;
  for (const std::int32_t c : spin) square += static_cast<std::int64_t>(c) * c;
  const std::int64_t speed = isqrt(static_cast<std::uint64_t>(square) << 10);  // x 2^-(exponent + 5) rad/s
  if (speed == 0) return {};
  constexpr std::uint64_t kTurnPerHalfRadian = 341782638;  // 2^32 / (4 pi)
  const auto angle = static_cast<std::uint64_t>(round_div(speed * dt, tick_rate));
  Turn turn;
  turn.half = static_cast<std::uint32_t>((angle * kTurnPerHalfRadian + (std::uint64_t{1} << (exponent + 4))) >> (exponent + 5));
  for (std::size_t i = 0; i < 3; ++i) {
    turn.axis[i] = static_cast<std::int32_t>(round_div(static_cast<std::int64_t>(spin[i]) << 35, speed));
  }
  return turn;
}

/// v * 2^exp, rounded; false when it is not finite or leaves +-limit.
bool quantise(double v, unsigned exp, double limit, std::int32_t& out) noexcept {
  const double scaled = std::floor(v * static_cast<double>(std::uint64_t{1} << exp) + 0.5);
  if (!(scaled >= -limit && scaled <= limit)) return false;
  out = static_cast<std::int32_t>(scaled);
  return true;
}

}  // namespace

RigidPose predict(const RigidState& state, std::int64_t tick, const StreamHeader& header) noexcept {
  const std::int64_t dt = std::min<std::int64_t>(tick - state.tick, header.max_extrapolation);
  RigidPose pose{state.position, state.rotation};
  if (dt == 0) return pose;
  const unsigned shift = static_cast<unsigned>(header.grid.position - header.grid.velocity);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t moved = round_div((state.velocity[i] * dt) << shift, header.tick_rate);
    pose.position[i] = saturate32(state.position[i] + moved);
  }
  const Turn turn = turn_of(state.spin, dt, header.tick_rate, header.grid.spin);
  if (turn.half != 0) pose.rotation = renormalise(multiply(axis_turn(turn.axis, turn.half), state.rotation));
  return pose;
}

Result<RigidState> to_grid(const RigidSample& sample, std::int64_t tick, const GridExponents& grid) noexcept {
  const Quat& q = sample.pose.rotation;
  if (!is_finite(sample.pose.position) || !is_finite(q) || !is_finite(sample.velocity) || !is_finite(sample.angular_velocity)) {
    return fail(Errc::invalid_argument, "R-API-1");
  }
  RigidState state;
  state.tick = tick;
  constexpr double kLimit = 2147483647.0;
  const auto vector = [](const Vec3& v, unsigned exp, double limit, Vec3i& out) {
    return quantise(v.x, exp, limit, out[0]) && quantise(v.y, exp, limit, out[1]) && quantise(v.z, exp, limit, out[2]);
  };
  if (!vector(sample.pose.position, grid.position, kLimit, state.position) ||
      !vector(sample.velocity, grid.velocity, kLimit, state.velocity) ||
      !vector(sample.angular_velocity, grid.spin, kSpinLimit, state.spin)) {
    return fail(Errc::invalid_argument, "R-API-2");
  }
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!(std::abs(length - 1) <= 1e-3)) return fail(Errc::invalid_argument, "R-API-3");
  const double scale = static_cast<double>(kOne30) / length;
  const double components[] = {q.w, q.x, q.y, q.z};
  for (std::size_t i = 0; i < 4; ++i) {
    state.rotation[i] = static_cast<std::int32_t>(std::min(std::floor(components[i] * scale + 0.5), static_cast<double>(kOne30)));
  }
  return state;
}

Pose to_pose(const RigidPose& pose, const GridExponents& grid) noexcept {
  const double metre = 1.0 / static_cast<double>(std::uint64_t{1} << grid.position);
  double q[4];
  double square = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    q[i] = pose.rotation[i];
    square += q[i] * q[i];
  }
  const double length = std::sqrt(square);
  return {{pose.position[0] * metre, pose.position[1] * metre, pose.position[2] * metre},
          {q[0] / length, q[1] / length, q[2] / length, q[3] / length}};
}

RigidSample to_sample(const RigidState& state, const GridExponents& grid) noexcept {
  const double speed = 1.0 / static_cast<double>(std::uint64_t{1} << grid.velocity);
  const double turn = 1.0 / static_cast<double>(std::uint64_t{1} << grid.spin);
  return {to_pose({state.position, state.rotation}, grid),
          {state.velocity[0] * speed, state.velocity[1] * speed, state.velocity[2] * speed},
          {state.spin[0] * turn, state.spin[1] * turn, state.spin[2] * turn}};
}

std::uint64_t state_hash(const StreamHeader& header, std::span<const RigidState> objects) noexcept {
  Fnv1a hash;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (header.objects[i].dof == Dof::none) continue;
    const RigidState& s = objects[i];
    hash.add64(static_cast<std::uint64_t>(s.tick));
    for (const std::int32_t c : s.position) hash.add32(c);
    for (const std::int32_t c : s.rotation) hash.add32(c);
    for (const std::int32_t c : s.velocity) hash.add32(c);
    for (const std::int32_t c : s.spin) hash.add32(c);
  }
  return hash.value();
}

}  // namespace tactus
