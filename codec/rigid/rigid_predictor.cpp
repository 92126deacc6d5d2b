// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_predictor.h>

#include <algorithm>

#include <tactus/base/fixed.h>

namespace tactus {
namespace {

constexpr std::int64_t kWhole = 1 << 15;

/// in   share  x 2^-15
std::int64_t part_of(std::int64_t way, std::int64_t share) noexcept {
  return share == kWhole ? way : round_shift(way * share, 15);
}

/// Half the angle turned in `dt` ticks, 2^32 to the full circle, and the axis. spec 40-rigid 4
struct Turn {
  Vec3i axis{};
  std::uint32_t half = 0;
};

/// in   share  of dt that is turned through, x 2^-15
Turn turn_of(const Vec3i& angular_velocity, std::int64_t dt, std::int64_t share, std::uint32_t tick_rate,
             unsigned exponent) noexcept {
  std::int64_t square = 0;
  for (const std::int32_t c : angular_velocity) square += static_cast<std::int64_t>(c) * c;
  const std::int64_t speed = isqrt(static_cast<std::uint64_t>(square) << 10);  // x 2^-(exponent + 5) rad/s
  if (speed == 0) return {};
  constexpr std::uint64_t kTurnPerHalfRadian = 341782638;  // 2^32 / (4 pi)
  const auto angle = static_cast<std::uint64_t>(part_of(round_div(speed * dt, tick_rate), share));
  Turn turn;
  turn.half = static_cast<std::uint32_t>((angle * kTurnPerHalfRadian + (std::uint64_t{1} << (exponent + 4))) >> (exponent + 5));
  for (std::size_t i = 0; i < 3; ++i) {
    turn.axis[i] = static_cast<std::int32_t>(round_div(static_cast<std::int64_t>(angular_velocity[i]) << 35, speed));
  }
  return turn;
}

/// How long an object slides until it rests [2^-8 ticks].
std::int64_t slide_time(const Vec3i& velocity, std::uint32_t tick_rate, std::int32_t deceleration) noexcept {
  std::uint64_t square = 0;
  for (const std::int32_t c : velocity) square += static_cast<std::uint64_t>(static_cast<std::int64_t>(c) * c);
  return round_div((static_cast<std::int64_t>(isqrt(square)) * tick_rate) << 8, deceleration);
}

/// The tick in which a sliding object comes to rest.
std::int64_t last_tick(std::int64_t rest) noexcept { return (rest + 255) >> 8; }

/// Share of the way at constant velocity that is left of it after `dt` ticks of sliding, x 2^-15.   pre  0 < dt <= last_tick(rest)
std::int64_t slide_share(std::int64_t dt, std::int64_t rest) noexcept {
  const std::int64_t t = dt << 8;
  return t <= rest ? kWhole - round_div(t << 14, rest) : round_div(rest << 14, t);
}

}  // namespace

std::int64_t RigidPredictor::gained(std::size_t axis, std::int64_t dt) const noexcept {
  return saturate32(round_div(scene_.motion->gravity[axis] * dt, scene_.tick_rate));
}

void RigidPredictor::fall(std::int64_t dt, RigidPose& pose) const noexcept {
  const unsigned shift = static_cast<unsigned>(scene_.grid.position - scene_.grid.velocity);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t fallen = round_div((gained(i, dt) * dt) << shift, 2 * std::int64_t{scene_.tick_rate});
    pose.position[i] = saturate32(pose.position[i] + fallen);
  }
}

RigidPose RigidPredictor::pose(const RigidState& state, std::int64_t tick) const noexcept {
  std::int64_t dt = std::min<std::int64_t>(tick - state.tick, scene_.max_extrapolation);
  std::int64_t share = kWhole;  // of dt
  RigidPose pose{state.position, state.rotation};
  if (state.predictor == Predictor::slide && dt > 0) {
    const std::int64_t rest = slide_time(state.velocity, scene_.tick_rate, scene_.motion->slide_deceleration);
    dt = std::min(dt, last_tick(rest));  // so that it rests to the bit
    if (dt > 0) share = slide_share(dt, rest);
  }
  if (dt == 0) return pose;
  constexpr std::int64_t kFar = std::int64_t{1} << 33;  // half of it is beyond every place
  const unsigned shift = static_cast<unsigned>(scene_.grid.position - scene_.grid.velocity);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t moved = std::clamp(round_div((state.velocity[i] * dt) << shift, scene_.tick_rate), -kFar, kFar);
    pose.position[i] = saturate32(state.position[i] + part_of(moved, share));
  }
  if (state.predictor == Predictor::ballistic) fall(dt, pose);
  const Turn turn = turn_of(state.angular_velocity, dt, share, scene_.tick_rate, scene_.grid.angular_velocity);
  if (turn.half != 0) pose.rotation = renormalise(multiply(axis_turn(turn.axis, turn.half), state.rotation));
  return pose;
}

void RigidPredictor::know(const DevicePath& path) {
  if (!scene_.driven) return;
  bodies_.resize(scene_.objects.size());
  path_ = &path;
}

RigidPose RigidPredictor::shown(std::uint32_t object, const RigidState& state, std::int64_t tick) const noexcept {
  if (state.predictor != Predictor::driven || path_ == nullptr) return pose(state, tick);
  return bodies_[object].pose(scene_, object, *path_, state, tick);
}

RigidMotion RigidPredictor::free_motion(const RigidState& state, std::int64_t dt) const noexcept {
  RigidMotion out{state.velocity, state.angular_velocity};
  if (state.predictor == Predictor::ballistic) {
    for (std::size_t i = 0; i < 3; ++i) out.velocity[i] = saturate32(state.velocity[i] + gained(i, dt));
  }
  if (state.predictor == Predictor::slide) {
    const std::int64_t rest = slide_time(state.velocity, scene_.tick_rate, scene_.motion->slide_deceleration);
    const std::int64_t left = (dt << 8) < rest ? kWhole - round_div(dt << 23, rest) : 0;
    for (std::size_t i = 0; i < 3; ++i) {
      out.velocity[i] = static_cast<std::int32_t>(round_shift(state.velocity[i] * left, 15));
      out.angular_velocity[i] = static_cast<std::int32_t>(round_shift(state.angular_velocity[i] * left, 15));
    }
  }
  return out;
}

RigidMotion RigidPredictor::motion(const RigidState& state, std::int64_t tick, const PoseError& error) const noexcept {
  const std::int64_t dt = tick - state.tick;
  if (dt == 0) return {state.velocity, state.angular_velocity};
  RigidMotion out = free_motion(state, std::min<std::int64_t>(dt, scene_.max_extrapolation));
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
