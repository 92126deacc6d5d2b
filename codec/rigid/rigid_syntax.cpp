// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_syntax.h>

#include <algorithm>
#include <cstdlib>

namespace tactus {

namespace {

constexpr StartModel<4> kRows[] = {
#include "rigid_start_models.inc"
};

}  // namespace

const RigidModels& start_models() noexcept {
  static const RigidModels models = unpack<RigidModels>(kRows);
  return models;
}

namespace {

/// What the pose residual implies for the velocities.
RigidMotion expected_motion(const RigidPredictor& predictor, const RigidState& base, std::int64_t tick,
                            const CodedUpdate& update) noexcept {
  PoseError error;
  if (update.reason != Reason::haptic) return predictor.motion(base, tick, error);
  for (std::size_t i = 0; i < 3; ++i) {
    error.position[i] = saturate32(static_cast<std::int64_t>(update.residual.of[0][i]) << update.level);
    error.rotation[i] = saturate32(static_cast<std::int64_t>(update.residual.of[2][i]) << update.level);
  }
  return predictor.motion(base, tick, error);
}

/// The turn with quarter-angle vector m / 2^exponent: (1 - |m|^2, 2 m) / (1 + |m|^2), regular up to a half turn where |m| = 1.
/// pre  |m| <= 2^exponent
Quat30 turn_of(const std::array<std::int64_t, 3>& m, std::int64_t square, unsigned exponent) noexcept {
  const std::int64_t one = std::int64_t{1} << exponent;
  const unsigned up = std::min(30u, 60 - 2 * exponent);  // the numerators stay below 2^62
  const std::int64_t divisor = (one * one + square) >> (30 - up);
  Quat30 out{static_cast<std::int32_t>(round_div((one * one - square) << up, divisor)), 0, 0, 0};
  for (std::size_t i = 0; i < 3; ++i) out[i + 1] = static_cast<std::int32_t>(round_div((2 * one * m[i]) << up, divisor));
  for (std::int32_t& c : out) c = std::clamp(c, -kOne30, kOne30);
  return out;
}

std::optional<RigidPose> add_pose(const RigidPose& predicted, const Residual& residual, unsigned level,
                                  const GridExponents& grid) noexcept {
  RigidPose out = predicted;
  const std::int64_t limit = std::int64_t{1} << grid.rotation;
  std::array<std::int64_t, 3> quarter{};
  std::int64_t square = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t moved = static_cast<std::int64_t>(residual.of[0][i]) << level;
    out.position[i] = saturate32(predicted.position[i] + moved);
    quarter[i] = static_cast<std::int64_t>(residual.of[2][i]) << level;
    if (quarter[i] > limit || quarter[i] < -limit) return std::nullopt;
    square += quarter[i] * quarter[i];
  }
  if (square > limit * limit) return std::nullopt;
  if (square != 0) out.rotation = renormalise(multiply(turn_of(quarter, square, grid.rotation), predicted.rotation));
  return out;
}

std::array<std::int32_t, 7> numbers_of(const DrivenContact& c) noexcept {
  return {c.point[0], c.point[1], c.point[2], c.normal[0], c.normal[1], c.normal[2], c.drag};
}

}  // namespace

void set_contact(const RigidState& base, const DrivenContact& contact, CodedUpdate& update) noexcept {
  const auto before = numbers_of(base.contact), now = numbers_of(contact);
  update.is_held = contact.is_held;
  for (std::size_t i = 0; i < now.size(); ++i) update.contact[i] = contact.is_held && i >= 3 ? 0 : now[i] - before[i];
}

DrivenContact contact_of(const RigidState& base, const CodedUpdate& update) noexcept {
  constexpr std::int64_t kMost = 1 << 20;
  const auto before = numbers_of(base.contact);
  const auto number = [&](std::size_t i) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(std::int64_t{before[i]} + update.contact[i], -kMost, kMost));
  };
  DrivenContact out{.is_held = update.is_held, .point = {number(0), number(1), number(2)}};
  if (!out.is_held) out.normal = {number(3), number(4), number(5)}, out.drag = number(6);
  return out;
}

/// What a signed magnitude can carry: 31 bits (R-RNG-4).
static std::int32_t codable(std::int64_t v) noexcept { return saturate32(std::max<std::int64_t>(v, -0x7fffffff)); }

Residual quantise_pose(const RigidPose& predicted, const RigidState& truth, std::uint8_t dof, unsigned level,
                       const GridExponents& grid) noexcept {
  Residual out;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t difference = static_cast<std::int64_t>(truth.position[i]) - predicted.position[i];
    if (dof >> i & 1u) out.of[0][i] = codable(round_shift(difference, level));
  }
  if (dof >> 3 == 0) return out;
  const Quat30 turn = multiply(truth.rotation, conjugate(predicted.rotation));
  std::int64_t square = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(dof >> (3 + i) & 1u)) continue;
    // v / (1 + w) = tan(angle / 4) * axis, of the quaternion of the pair (q, -q) whose w is not negative
    const std::int64_t v = turn[0] < 0 ? -static_cast<std::int64_t>(turn[i + 1]) : turn[i + 1];
    const std::int64_t w = kOne30 + std::abs(static_cast<std::int64_t>(turn[0]));
    out.of[2][i] = static_cast<std::int32_t>(round_div(v << grid.rotation, w << level));
    square += static_cast<std::int64_t>(out.of[2][i]) * out.of[2][i];
  }
  // A half turn may round to just over length 1: take the longest component back.
  while (square << (2 * level) > std::int64_t{1} << (2 * grid.rotation)) {
    auto& v = out.of[2];
    auto& longest =
        *std::max_element(v.begin(), v.end(), [](std::int32_t a, std::int32_t b) { return std::abs(a) < std::abs(b); });
    square -= 2 * static_cast<std::int64_t>(std::abs(longest)) - 1;
    longest += longest > 0 ? -1 : 1;
  }
  return out;
}

void quantise_motion(const RigidPredictor& predictor, const Prediction& prediction, const RigidState& truth, std::uint8_t dof,
                     CodedUpdate& update) noexcept {
  const RigidMotion expected = expected_motion(predictor, prediction.base, truth.tick, update);
  const auto steps = [shift = unsigned{update.level}](std::int32_t value, std::int32_t guess) {
    return codable(round_shift(value, shift) - round_shift(guess, shift));
  };
  Residual& residual = update.residual;
  for (std::size_t i = 0; i < 3; ++i) {
    residual.of[1][i] = dof >> i & 1u ? steps(truth.velocity[i], expected.velocity[i]) : 0;
    residual.of[3][i] = dof >> (3 + i) & 1u ? steps(truth.angular_velocity[i], expected.angular_velocity[i]) : 0;
  }
}

std::optional<RigidState> reconstruct(const RigidPredictor& predictor, const Prediction& prediction, std::int64_t tick,
                                      const CodedUpdate& update, const GridExponents& grid) noexcept {
  const auto pose = add_pose(prediction.pose, update.residual, update.level, grid);
  if (!pose) return std::nullopt;
  const RigidMotion motion = expected_motion(predictor, prediction.base, tick, update);
  RigidState out{tick,
                 pose->position,
                 pose->rotation,
                 motion.velocity,
                 motion.angular_velocity,
                 update.predictor,
                 update.smoothing_exp,
                 update.retained,
                 static_cast<std::uint8_t>((prediction.base.lod + update.lod) & 7u),
                 prediction.base.contact};
  if (out.predictor == Predictor::driven) out.contact = contact_of(prediction.base, update);
  const unsigned shift = update.level;
  for (std::size_t i = 0; i < 3; ++i) {
    out.velocity[i] = saturate32((round_shift(motion.velocity[i], shift) + update.residual.of[1][i]) << shift);
    const std::int64_t turning = (round_shift(motion.angular_velocity[i], shift) + update.residual.of[3][i]) << shift;
    out.angular_velocity[i] =
        static_cast<std::int32_t>(std::clamp<std::int64_t>(turning, -kAngularVelocityLimit, kAngularVelocityLimit));
  }
  return out;
}

std::size_t max_rigid_packet(const Scene& scene) noexcept {
  constexpr std::size_t kHead = 64;  // key, baseline, tick, count, tail
  constexpr std::size_t kUpdate =
      208;  // gap, reason, level, predictor, smoothing_exp, retained, lod and 12 components at 15 bits per adaptive bit
  const std::size_t contact = scene.driven ? 88 : 0;  // 7 more
  return kHead + (kUpdate + contact) * scene.moving().size();
}

}  // namespace tactus
