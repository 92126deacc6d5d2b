// SPDX-License-Identifier: Apache-2.0
/// Syntax and reconstruction of a rigid packet: shared by encoder and decoder, internal to the library. spec/40-rigid.md 2, 3 and 5.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>

#include <tactus/base/fixed.h>
#include <tactus/base/range_coder.h>
#include <tactus/packet/packet.h>
#include <tactus/packet/substream.h>
#include <tactus/rigid/rigid_predictor.h>
#include <tactus/scene/scene.h>

namespace tactus {

inline constexpr std::size_t kQuantities = 4;  // position, velocity, rotation, angular velocity
inline constexpr std::size_t kPoseContexts = 12, kMotionContexts = 25;

/// Of a pose residual and the motion residual beside it.
struct ResidualModels {
  std::array<MagnitudeModel, kPoseContexts> pose;
  std::array<MagnitudeModel, kMotionContexts> motion;
  std::array<BitModel, 4> sign;  // of a motion: not that of the pose; by reason
};

/// Every adaptive model of a packet. Restarted from start_models() for each packet, so that a packet depends on its baseline
/// only.
struct RigidModels {
  BitModel key;
  MagnitudeModel baseline;
  MagnitudeModel tick_delta;
  MagnitudeModel count;
  MagnitudeModel gap;
  TreeModel<2> reason;
  TreeModel<4> level;
  TreeModel<3> smoothing_exp;
  TreeModel<2> retained;
  std::array<ResidualModels, 2> residual;              // position and velocity; rotation and angular velocity
  std::array<TreeModel<kPredictorBits>, 8> predictor;  // by reason; in driven scenes by 4 + reason
  std::array<MagnitudeModel, 3> contact;               // of point, normal and drag
  TreeModel<3> lod;
};

/// Start probabilities, spec/40-rigid.md table 2.
const RigidModels& start_models() noexcept;

struct RigidHead : PacketHead {
  std::uint32_t count = 1;  ///< updates
};

/// Quantised differences from the prediction, in units of 2^level grid steps; components an object lacks stay 0.
struct Residual {
  std::array<Vec3i, kQuantities> of{};
};

struct CodedUpdate {
  Reason reason = Reason::request;
  std::uint8_t level = 0;
  std::uint8_t smoothing_exp = 0, retained = 0;  ///< as in RigidState; 0 in a scene that is not smoothed
  Residual residual;
  Predictor predictor = Predictor::linear;
  std::uint8_t lod = 0;                   ///< less that of the baseline, modulo 8
  bool is_held = false;                   ///< driven: as in DrivenContact
  std::array<std::int32_t, 7> contact{};  ///< driven: differences of point, normal and drag from those of the baseline
};

template <class Coder>
void code_head(Coder& coder, RigidModels& models, const Scene& scene, RigidHead& head) noexcept {
  code_baseline(coder, models, scene.baseline_span, head);
  head.tick_delta = coder.magnitude(models.tick_delta, head.tick_delta);
  if (scene.moving().size() > 1) head.count = coder.magnitude(models.count, head.count);
}

/// Context of a component of position or rotation: the reason, then how large the components before were.
constexpr std::size_t pose_context(Reason reason, bool is_first, std::uint32_t largest) noexcept {
  if (is_first) return static_cast<std::size_t>(reason);
  return 4 + std::min(static_cast<std::size_t>(std::bit_width(largest)), std::size_t{7});
}

/// Context of a component of a velocity: how large the components before were, and that of the pose on the same axis.
constexpr std::size_t motion_context(bool is_first, std::uint32_t largest, std::uint32_t pose) noexcept {
  constexpr std::array<std::size_t, 6> kBefore{1, 2, 2, 3, 3, 3}, kPose{0, 1, 2, 2, 3, 3};  // by width
  const auto before = static_cast<std::size_t>(std::bit_width(largest)), of_pose = static_cast<std::size_t>(std::bit_width(pose));
  return 5 * (is_first ? 0 : before < 6 ? kBefore[before] : 4) + (of_pose < 6 ? kPose[of_pose] : 4);
}

/// Position and velocity, or rotation and angular velocity.
template <class Coder>
void code_residual(Coder& coder, ResidualModels& models, unsigned axes, Reason reason, Vec3i& pose, Vec3i& motion) noexcept {
  bool is_first = true;
  std::uint32_t largest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(axes >> axis & 1u)) continue;
    pose[axis] = coder.signed_value(models.pose[pose_context(reason, is_first, largest)], pose[axis]);
    largest = std::max(largest, magnitude_of(pose[axis]));
    is_first = false;
  }
  is_first = true;
  largest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(axes >> axis & 1u)) continue;
    MagnitudeModel& model = models.motion[motion_context(is_first, largest, magnitude_of(pose[axis]))];
    motion[axis] = coder.signed_value(model, models.sign[static_cast<std::size_t>(reason)], pose[axis], motion[axis]);
    largest = std::max(largest, magnitude_of(motion[axis]));
    is_first = false;
  }
}

/// What a smoothed update mostly has: the longest of at most 1/62 s, so that its symbol is the same at every tick rate.
constexpr std::uint8_t usual_smoothing_exp(std::uint32_t tick_rate) noexcept {
  const auto width = static_cast<unsigned>(std::bit_width(std::min(tick_rate / 62, 255u)));
  return static_cast<std::uint8_t>(width > 0 ? width - 1 : 0);
}

/// Where the device touches the object.
template <class Coder>
void code_contact(Coder& coder, RigidModels& models, CodedUpdate& update) noexcept {
  update.is_held = coder.raw(1, update.is_held ? 1u : 0u) != 0;
  const std::size_t count = update.is_held ? 3 : 7;
  for (std::size_t i = 0; i < count; ++i) update.contact[i] = coder.signed_value(models.contact[i / 3], update.contact[i]);
}

template <class Coder>
void code_update(Coder& coder, RigidModels& models, const Scene& scene, std::uint32_t object, CodedUpdate& update) noexcept {
  const std::uint8_t dof = scene.objects[object].dof;
  update.reason = static_cast<Reason>(coder.template tree<2>(models.reason, static_cast<std::uint32_t>(update.reason)));
  update.level = static_cast<std::uint8_t>(coder.template tree<4>(models.level, update.level));
  if (scene.interest) update.lod = static_cast<std::uint8_t>(coder.template tree<3>(models.lod, update.lod));
  if (scene.is_smoothed) {
    const std::uint32_t usual = usual_smoothing_exp(scene.tick_rate);
    update.smoothing_exp = static_cast<std::uint8_t>(
        (usual - coder.template tree<3>(models.smoothing_exp, (usual - update.smoothing_exp) & 7u)) & 7u);
  }
  if (update.smoothing_exp > 0)
    update.retained = static_cast<std::uint8_t>(coder.template tree<2>(models.retained, update.retained));
  if (has_predictors(scene)) {
    auto& model = models.predictor[static_cast<std::size_t>(update.reason) + (scene.driven ? 4 : 0)];
    update.predictor =
        static_cast<Predictor>(coder.template tree<kPredictorBits>(model, static_cast<std::uint32_t>(update.predictor)));
  }
  if (update.predictor == Predictor::driven && scene.driven) code_contact(coder, models, update);
  auto& of = update.residual.of;
  code_residual(coder, models.residual[0], dof & 7u, update.reason, of[0], of[1]);
  code_residual(coder, models.residual[1], dof >> 3, update.reason, of[2], of[3]);
}

/// Set the differences that signal `contact`.
void set_contact(const RigidState& base, const DrivenContact& contact, CodedUpdate& update) noexcept;
/// The contact that they signal.
DrivenContact contact_of(const RigidState& base, const CodedUpdate& update) noexcept;

/// State of one object before a packet, and its predicted pose at the packet's tick.
struct Prediction {
  const RigidState& base;
  RigidPose pose;
};

/// The pose residual alone: quantise `truth` against `predicted`.
Residual quantise_pose(const RigidPose& predicted, const RigidState& truth, std::uint8_t dof, unsigned level,
                       const GridExponents& grid) noexcept;

/// The residual of both velocities, given that of the pose. For an update of the haptic trigger it is the difference from
/// RigidPredictor::motion(), which assumes a steady change of velocity. Steps count from zero, so that an object at rest stays at
/// rest at every level. spec 40-rigid 5.2
void quantise_motion(const RigidPredictor& predictor, const Prediction& prediction, const RigidState& truth, std::uint8_t dof,
                     CodedUpdate& update) noexcept;

/// The decoder's state after the update: prediction plus residual. Nothing when the rotation residual is longer than 1 (R-RIG-6).
std::optional<RigidState> reconstruct(const RigidPredictor& predictor, const Prediction& prediction, std::int64_t tick,
                                      const CodedUpdate& update, const GridExponents& grid) noexcept;

/// Upper bound of the size of any packet of a scene's rigid objects, without its substream's number [bytes].
std::size_t max_rigid_packet(const Scene& scene) noexcept;

}  // namespace tactus
