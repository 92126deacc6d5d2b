// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/thesis_decoder.h>

#include <algorithm>

#include <tactus/base/rule.h>
#include <tactus/deformable/displacement.h>

namespace tactus {

ThesisDecoder::ThesisDecoder(const Scene& scene, const DeformableObject& object)
    : object_(object),
      baseline_span_(scene.baseline_span),
      start_(initial_thesis_models(object)),
      models_(start_),
      next_(initial_thesis_state(object)) {
  listed_.reserve(object.rest.size());
}

Result<PacketHead> ThesisDecoder::read_head(std::span<const std::uint8_t> payload) noexcept {
  in_ = ByteReader(payload);
  head_ = {};
  const std::uint8_t key = in_.u8();
  if (key > 1) return fail(Errc::malformed, "R-DEF-11", bit());
  head_.key = key == 1;
  if (!head_.key && baseline_span_ > 1)
    head_.baseline_delta = static_cast<std::uint32_t>(std::min<std::uint64_t>(in_.varint(), 0xffffffff));
  const std::uint64_t tick_delta = in_.varint(), count = in_.varint(), list_bytes = in_.varint(), lowest = in_.varint(),
                      range = in_.varint();
  if (in_.overrun()) return fail(Errc::truncated, "R-DEF-11", bit());
  if (!in_.ok()) return fail(Errc::malformed, "R-DEF-11", bit());
  constexpr std::uint64_t kSpan = std::uint64_t{4} * DeformableObject::kMaxDisplacement;
  if (tick_delta > 0xffffffff || count < 1 || count > object_.rest.size() || lowest > kSpan || range > kSpan)
    return fail(Errc::invalid, "R-DEF-12", bit());
  if (list_bytes > in_.remaining()) return fail(Errc::truncated, "R-DEF-11", bit());
  head_.tick_delta = static_cast<std::uint32_t>(tick_delta);
  head_.count = static_cast<std::uint32_t>(count);
  head_.list_bytes = static_cast<std::uint32_t>(list_bytes);
  head_.lowest = static_cast<std::int32_t>(unzigzag(lowest));
  head_.range = static_cast<std::uint32_t>(range);
  return head_;
}

Result<void> ThesisDecoder::read_list(RangeDecoder coder) noexcept {
  listed_.clear();
  std::uint64_t next = 0;
  const auto vertices = static_cast<std::uint32_t>(object_.rest.size());
  for (std::uint32_t i = 0; i < head_.count; ++i) {
    next += code_gap(coder, models_, 0xffffffff, vertices);
    if (next >= vertices) return fail(Errc::invalid, "R-DEF-13", bit());
    listed_.push_back({static_cast<std::uint32_t>(next++), {}});
  }
  if (const RuleName rule = coder.broken_rule()) return fail(Errc::malformed, rule, bit());
  return {};
}

Result<void> ThesisDecoder::read_body(const ThesisState& base, std::int64_t, DecodedPacket& out) noexcept {
  models_ = object_.models_kept ? base.models : start_;
  TACTUS_CHECK(read_list(RangeDecoder(in_.bytes(head_.list_bytes))));
  RangeDecoder coder(in_.bytes(in_.remaining()));
  const auto symbols = std::span<BitModel>(models_).subspan(kIndexModels);
  for (ListedVertex& l : listed_)
    for (std::uint32_t& s : l.symbol) s = code_symbol(coder, symbols, object_.quant_bits, 0);
  if (const RuleName rule = coder.broken_rule()) return fail(Errc::malformed, rule, bit());

  next_.displacement = base.displacement;
  for (const ListedVertex& l : listed_) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      auto& u = next_.displacement[l.vertex][axis];
      u = limited_displacement(std::int64_t{u} + restore_error(l.symbol[axis], head_, object_.quant_bits));
    }
  }
  if (object_.models_kept) next_.models = models_;
  out.vertices = head_.count;
  out.final_range = coder.range();
  out.final_code = coder.code();
  return {};
}

}  // namespace tactus
