// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/deformable_decoder.h>

#include <tactus/base/rule.h>
#include <tactus/scene/thesis_component.h>

namespace tactus {

// ==== main decoder ====

Result<PacketHead> MainDecoder::read_head(std::span<const std::uint8_t> payload) noexcept {
  coder_ = RangeDecoder(payload);
  payload_ = payload.size();
  models_ = main_start_models();
  head_ = {};
  code_main_start(coder_, models_, object_, baseline_span_, head_);
  if (coder_.too_wide()) return fail(Errc::malformed, "R-RNG-4", bit());
  return head_;
}

Result<void> MainDecoder::read_body(const MainState& base, std::int64_t, DecodedPacket& out) noexcept {
  const auto updates = reader_.read(coder_, models_, head_, base, next_);
  if (!updates) return fail_at(updates.error(), bit());
  if (const RuleName rule = coder_.broken_rule()) return fail(Errc::malformed, rule, bit());
  out.layer = head_.layer;
  out.vertices = *updates;
  out.final_range = coder_.range();
  out.final_code = coder_.code();
  return {};
}

std::span<const Vec3i> MainDecoder::predict(const MainState& state, std::int64_t tick) noexcept {
  if (driven_) driven_->follow(tick);
  if (state.following != Following::none && driven_ && driven_->show(state, tick, shown_)) return shown_;
  return reader_.predict(state, tick);
}

// ==== deformable decoder ====

std::unique_ptr<DeformableDecoder> DeformableDecoder::create(const Scene& scene, std::size_t object, const DecodeLimits& limits,
                                                             std::unique_ptr<FollowedShape> driven) {
  const DeformableObject& o = scene.deformables[object];
  if (o.profile == DeformableProfile::thesis) return scene.thesis()->decoder(scene, object, limits);
  return std::make_unique<DeformableDecoderOf<MainDecoder>>(scene, object, limits, initial_main_state(o), std::move(driven));
}

}  // namespace tactus
