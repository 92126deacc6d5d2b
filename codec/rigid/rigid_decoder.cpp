// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_decoder.h>

#include <tactus/base/rule.h>

namespace tactus {

RigidDecoder::RigidDecoder(const Scene& scene) : scene_(scene), predictor_(scene), models_(start_models()) {
  updates_.reserve(scene.moving().size());
  states_.reserve(scene.moving().size());
}

Result<PacketHead> RigidDecoder::read_head(std::span<const std::uint8_t> payload) noexcept {
  coder_ = RangeDecoder(payload);
  payload_ = payload.size();
  models_ = start_models();
  head_ = {};
  code_head(coder_, models_, scene_, head_);
  if (coder_.too_wide()) return fail(Errc::malformed, "R-RNG-4", bit());
  return head_;
}

Result<void> RigidDecoder::read_updates(const RigidStates& base, std::int64_t tick) noexcept {
  const auto moving = scene_.moving();
  std::uint64_t next = 0;  // index into `moving`
  for (std::uint32_t i = 0; i < head_.count; ++i) {
    if (moving.size() > 1) next += coder_.magnitude(models_.gap, 0);
    if (coder_.too_wide()) return fail(Errc::malformed, "R-RNG-4", bit());
    if (next >= moving.size()) return fail(Errc::invalid, "R-RIG-4", bit());
    const std::uint32_t object = moving[static_cast<std::size_t>(next++)];
    CodedUpdate update;
    code_update(coder_, models_, scene_, object, update);
    if (coder_.too_wide()) return fail(Errc::malformed, "R-RNG-4", bit());
    if (!is_declared(scene_, object, update.predictor)) return fail(Errc::invalid, "R-RIG-7", bit());
    const RigidState& state = base.objects[object];
    const auto after = reconstruct(predictor_, {state, predictor_.pose(state, tick)}, tick, update, scene_.grid);
    if (!after) return fail(Errc::invalid, "R-RIG-6", bit());
    updates_.push_back({object, update.reason, update.level});
    states_.push_back(*after);
  }
  return {};
}

Result<void> RigidDecoder::read_body(const RigidStates& base, std::int64_t tick, DecodedPacket& out) noexcept {
  updates_.clear();
  states_.clear();
  if (head_.count < 1 || head_.count > scene_.moving().size()) return fail(Errc::invalid, "R-RIG-3", bit());
  TACTUS_CHECK(read_updates(base, tick));
  if (const RuleName rule = coder_.broken_rule()) return fail(Errc::malformed, rule, bit());
  out.updates = updates_;
  out.final_range = coder_.range();
  out.final_code = coder_.code();
  return {};
}

void RigidDecoder::commit(const RigidStates& base, RigidStates& next) noexcept {
  if (&base != &next) next.objects = base.objects;
  for (std::size_t i = 0; i < updates_.size(); ++i) next.objects.set(updates_[i].object, states_[i]);
}

}  // namespace tactus
