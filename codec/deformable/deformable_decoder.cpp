// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/deformable_decoder.h>

#include <algorithm>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/deformable/thesis_decoder.h>
#include <tactus/packet/substream_decoder.h>

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

namespace {

template <class Codec>
class Of final : public DeformableDecoder {
 public:
  template <class... More>
  Of(const Scene& scene, std::size_t index, const DecodeLimits& limits, typename Codec::State initial, More&&... more)
      : object_(scene.deformables[index]),
        stream_(scene, limits, std::move(initial), scene, object_, std::forward<More>(more)...),
        number_(index + 1) {}

  Result<DecodedPacket> decode(std::uint64_t number, std::span<const std::uint8_t> packet) noexcept override {
    TACTUS_TRY(DecodedPacket decoded, stream_.decode(number, packet));
    decoded.substream = number_;
    return decoded;
  }
  std::span<const Vec3i> displacements() const noexcept override { return stream_.newest().displacement; }
  std::span<const Vec3i> displacements_at(std::int64_t tick) noexcept override { return predict(stream_.newest(), tick); }
  std::span<const Vec3i> displacements_of(std::int64_t tick) noexcept override { return predict(stream_.at(tick), tick); }
  bool holds(std::uint64_t number) const noexcept override { return stream_.holds(number); }
  std::int64_t tick() const noexcept override { return stream_.newest().tick; }
  std::uint64_t state_hash() const noexcept override { return tactus::state_hash(object_, stream_.newest()); }

 private:
  std::span<const Vec3i> predict(const typename Codec::State& state, std::int64_t tick) noexcept {
    return stream_.codec().predict(state, std::clamp(tick, state.tick, kTickLimit));
  }

  const DeformableObject& object_;
  SubstreamDecoder<Codec> stream_;
  std::size_t number_;
};

}  // namespace

std::unique_ptr<DeformableDecoder> DeformableDecoder::create(const Scene& scene, std::size_t object, const DecodeLimits& limits,
                                                             std::unique_ptr<FollowedShape> driven) {
  const DeformableObject& o = scene.deformables[object];
  if (o.profile == DeformableProfile::thesis)
    return std::make_unique<Of<ThesisDecoder>>(scene, object, limits, initial_thesis_state(o));
  return std::make_unique<Of<MainDecoder>>(scene, object, limits, initial_main_state(o), std::move(driven));
}

}  // namespace tactus
