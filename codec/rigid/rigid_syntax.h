// SPDX-License-Identifier: Apache-2.0
/// Syntax and reconstruction of a rigid packet: shared by encoder and decoder, internal to the library. spec/40-rigid.md 2, 3 and 5.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>

#include <tactus/base/fixed.h>
#include <tactus/base/range_coder.h>
#include <tactus/packet/packet_head.h>
#include <tactus/packet/reason.h>
#include <tactus/rigid/rigid_predictor.h>
#include <tactus/scene/scene.h>

namespace tactus {

inline constexpr std::size_t kQuantities = 4;  // position, velocity, rotation, angular velocity
inline constexpr std::size_t kContexts = 8;    // 0..3: the reason, 4..7: how large the components before were

/// Every adaptive model of a packet. Restarted from start_models() for each packet, so that a packet depends on its baseline
/// only.
struct RigidModels {
  BitModel key;
  MagnitudeModel baseline;
  MagnitudeModel tick_delta;
  MagnitudeModel count;
  MagnitudeModel gap;
  TreeModel<2> reason;
  TreeModel<3> level;
  std::array<std::array<MagnitudeModel, kContexts>, kQuantities> residual;
  std::array<TreeModel<2>, 4> predictor;  ///< by reason
};

/// Start probabilities, spec/40-rigid.md table 2.
const RigidModels& start_models() noexcept;

struct RigidHead : PacketHead {
  std::uint32_t count = 1;  ///< updates
};

/// Quantised differences from the prediction, in units of 4^level grid steps; components an object lacks stay 0.
struct Residual {
  std::array<Vec3i, kQuantities> of{};
};

struct CodedUpdate {
  Reason reason = Reason::request;
  std::uint8_t level = 0;
  Residual residual;
  std::uint8_t predictor = 0;
};

template <class Coder>
void code_head(Coder& coder, RigidModels& models, const Scene& scene, RigidHead& head) noexcept {
  code_baseline(coder, models, scene.baseline_span, head);
  head.tick_delta = coder.magnitude(models.tick_delta, head.tick_delta);
  if (scene.moving().size() > 1) head.count = coder.magnitude(models.count, head.count);
}

/// Magnitude context of the next component: how large its predecessors were.
constexpr std::size_t size_context(std::uint32_t magnitude) noexcept {
  const auto width = static_cast<unsigned>(std::bit_width(magnitude));
  return width == 0 ? 4 : width < 3 ? 5 : width < 6 ? 6 : 7;
}

template <class Coder>
void code_update(Coder& coder, RigidModels& models, const Scene& scene, std::uint32_t object, CodedUpdate& update) noexcept {
  const std::uint8_t dof = scene.objects[object].dof;
  update.reason = static_cast<Reason>(coder.template tree<2>(models.reason, static_cast<std::uint32_t>(update.reason)));
  update.level = static_cast<std::uint8_t>(coder.template tree<3>(models.level, update.level));
  std::size_t context = static_cast<std::size_t>(update.reason);
  if (scene.motion)
    update.predictor = static_cast<std::uint8_t>(coder.template tree<2>(models.predictor[context], update.predictor));
  for (std::size_t quantity = 0; quantity < kQuantities; ++quantity) {
    const unsigned axes = quantity < 2 ? dof & 7u : static_cast<unsigned>(dof >> 3);
    if (axes == 0) continue;
    if (quantity == 2) context = static_cast<std::size_t>(update.reason);
    std::uint32_t largest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!(axes >> axis & 1u)) continue;
      std::int32_t& value = update.residual.of[quantity][axis];
      value = coder.signed_value(models.residual[quantity][context], value);
      const std::uint32_t size = static_cast<std::uint32_t>(value < 0 ? -value : value);
      if (size > largest) largest = size;
      context = size_context(largest);
    }
  }
}

/// Does the scene declare what this predictor needs? (R-RIG-7)
bool is_declared(const Scene& scene, std::uint8_t predictor) noexcept;

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
