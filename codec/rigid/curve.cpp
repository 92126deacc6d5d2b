// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/curve.h>

#include <algorithm>
#include <array>

#include <tactus/base/fixed.h>

namespace tactus {

// ==== curve ====

namespace {

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

/// v << shift, kept where round_div() by a tick rate may have it: beyond, the quotient does not fit 32 bits anyway.
std::int64_t shifted(std::int64_t v, unsigned shift) noexcept {
  const std::int64_t limit = (std::int64_t{1} << (62 - shift)) - 1;
  return std::clamp(v, -limit, limit) * (std::int64_t{1} << shift);
}

}  // namespace

Cubic cubic(std::int64_t u) noexcept {
  const std::int64_t u2 = round_shift(u * u, 30), u3 = round_shift(u2 * u, 30);
  return {3 * u2 - 2 * u3, u3 - u2};
}

PoseOffset offset_between(const RigidPose& from, const RigidPose& to) noexcept {
  PoseOffset out{.rotation = half_vector(multiply(to.rotation, conjugate(from.rotation)))};
  for (std::size_t i = 0; i < 3; ++i) out.position[i] = saturate32(std::int64_t{to.position[i]} - from.position[i]);
  return out;
}

PoseOffset change_between(const Scene& scene, const RigidMotion& before, const RigidMotion& after, std::int64_t ticks) noexcept {
  constexpr std::int64_t kTurnPerHalfRadian = 341782638;  // 2^32 / (4 pi)
  const auto shift = static_cast<unsigned>(scene.grid.position - scene.grid.velocity);
  PoseOffset out;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t change = saturate32(std::int64_t{after.velocity[i]} - before.velocity[i]);
    out.position[i] = saturate32(round_div(shifted(change * ticks, shift), scene.tick_rate));
    const std::int64_t spun = std::int64_t{after.angular_velocity[i]} - before.angular_velocity[i];
    const std::int64_t radians = round_div(spun * ticks, scene.tick_rate);
    out.rotation[i] = saturate32(round_shift(radians * kTurnPerHalfRadian, scene.grid.angular_velocity));
  }
  return out;
}

RigidPose displaced(const RigidPose& pose, const PoseOffset& error, const PoseOffset& change,
                    const CurveWeights& weights) noexcept {
  RigidPose out;
  Vec3i half{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t moved = weights.position * error.position[i] + weights.change * change.position[i];
    out.position[i] = saturate32(pose.position[i] + round_shift(moved, 30));
    half[i] =
        static_cast<std::int32_t>(round_shift(weights.rotation * error.rotation[i] + weights.change * change.rotation[i], 30));
  }
  out.rotation = turned(half, pose.rotation);
  return out;
}

// ==== error smoothing ====

PoseOffset part_kept(const PoseOffset& whole, std::uint8_t retained) noexcept {
  constexpr std::array kSixteenths{16, 15, 12, 8};
  const std::int64_t kept = kSixteenths[retained];
  PoseOffset out;
  for (std::size_t i = 0; i < 3; ++i) {
    out.position[i] = static_cast<std::int32_t>(round_shift(whole.position[i] * kept, 4));
    out.rotation[i] = static_cast<std::int32_t>(round_shift(whole.rotation[i] * kept, 4));
  }
  return out;
}

PoseOffset kept_offset(const RigidPose& shown, const RigidState& update) noexcept {
  return part_kept(offset_between({update.position, update.rotation}, shown), update.retained);
}

RigidPose smoothed(const RigidPose& pose, const RigidState& update, const PoseOffset& offset, std::int64_t tick) noexcept {
  if (!is_smoothing(update, tick)) return pose;
  const std::int64_t left = ((std::int64_t{1} << update.smoothing_exp) - (tick - update.tick)) << (30 - update.smoothing_exp);
  return displaced(pose, offset, {}, {left, left, 0});
}

void SmoothedPath::follow(const RigidPredictor& predictor, const RigidState& update) noexcept {
  if (update.smoothing_exp > 0) offset = kept_offset(pose(predictor, std::max(update.tick, state.tick)), update);
  state = update;
}

}  // namespace tactus
