// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <tactus/deformable/encoder_side.h>
#include <tactus/deformable/thesis_syntax.h>

namespace tactus {
namespace {

class ThesisSide : public DeformableEncoderSide {
 public:
  ThesisSide(const StreamHeader& header, const DeformableObject& mesh, const DeformableEncoderOptions& options)
      : DeformableEncoderSide(header, mesh, options),
        cold_(initial_thesis_models(mesh)),
        models_(cold_),
        list_(max_deformable_packet_size(mesh)) {
    listed_.reserve(mesh.rest.size());
    inside_.resize(mesh.rest.size());
  }
  EncodedDeformablePacket encode(const DeformableTruth& frame, Layer half) noexcept override;

 private:
  void list_vertices(const DeformableTruth& frame, const DeformableState& state, Layer half) noexcept;
  ThesisHead head_for(const DeformableTruth& frame, bool key) const noexcept;
  std::size_t write_head(const ThesisHead& head, std::span<std::uint8_t> packet) noexcept;
  std::size_t write_list() noexcept;

  std::vector<BitModel> cold_, models_;
  std::vector<std::uint8_t> list_;     // the coded index list
  std::vector<std::uint32_t> listed_;  // vertices of the packet at hand
  std::vector<std::uint8_t> inside_;   // in the area of interest
};

/// Eqs. 3.10 and 3.11: an error against `state` that reaches a threshold includes the vertex. Ascending order.
void ThesisSide::list_vertices(const DeformableTruth& frame, const DeformableState& state, Layer half) noexcept {
  const DeformableThresholds& t = options_.thresholds;
  const auto squared_units = [this](double metres) {
    const double units = std::ldexp(metres, header_.grid.position);
    return units * units;
  };
  const double visual = squared_units(t.visual);
  double haptic = visual;
  std::span<const std::uint32_t> felt;
  if (is_felt(frame)) {
    haptic = std::min(visual, squared_units(haptic_threshold(t, *frame.touch)));
    felt = area(frame.touch->triangle);
  }
  for (const std::uint32_t v : felt) inside_[v] = 1;
  expected_ = state.displacement;
  listed_.clear();
  for (std::uint32_t v = 0; v < frame.truth.size(); ++v) {
    const bool inside = inside_[v] != 0;
    if (half == (inside ? Layer::visual : Layer::haptic)) continue;
    if (static_cast<double>(squared_distance(frame.truth[v], expected_[v])) >= (inside ? haptic : visual)) listed_.push_back(v);
  }
  for (const std::uint32_t v : felt) inside_[v] = 0;
}

ThesisHead ThesisSide::head_for(const DeformableTruth& frame, bool key) const noexcept {
  ThesisHead head;
  head.key = key;
  head.baseline_delta = static_cast<std::uint8_t>(baseline_delta());
  head.tick_delta = static_cast<std::uint32_t>(frame.tick - base(key).tick);
  head.count = static_cast<std::uint32_t>(listed_.size());
  std::int32_t low = DeformableObject::kMaxDisplacement * 2, high = -low;
  for (const std::uint32_t v : listed_) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int32_t e = frame.truth[v][axis] - expected_[v][axis];
      low = std::min(low, e);
      high = std::max(high, e);
    }
  }
  head.lowest = low;
  head.range = static_cast<std::uint32_t>(high - low);
  return head;
}

std::size_t ThesisSide::write_list() noexcept {
  RangeEncoder coder(list_);
  std::uint32_t at = 0;
  for (const std::uint32_t v : listed_) {
    code_gap(coder, models_, v - at, 0xfffffffe);
    at = v + 1;
  }
  return coder.finish();
}

/// Everything before the index list; returns where the list begins.
std::size_t ThesisSide::write_head(const ThesisHead& head, std::span<std::uint8_t> packet) noexcept {
  std::size_t at = 2;
  const auto varint = [&](std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) packet[at++] = static_cast<std::uint8_t>(value | 0x80);
    packet[at++] = static_cast<std::uint8_t>(value);
  };
  packet[at++] = head.key ? 1 : 0;
  if (!head.key && header_.baseline_span > 1) packet[at++] = head.baseline_delta;
  varint(head.tick_delta);
  varint(head.count);
  varint(head.list_bytes);
  varint(static_cast<std::uint32_t>(head.lowest) << 1 ^ static_cast<std::uint32_t>(head.lowest >> 31));
  varint(head.range);
  return at;
}

EncodedDeformablePacket ThesisSide::encode(const DeformableTruth& frame, Layer half) noexcept {
  const bool key = key_due(frame.tick);
  if (half == Layer::haptic && !is_felt(frame)) return {};
  list_vertices(frame, held_, key ? Layer::all : half);  // a key packet forgets the whole shape
  if (listed_.empty() && !key_requested()) return {};
  // What is felt goes first: a key packet of the rest alone would forget it.
  if (half == Layer::visual && key && is_felt(frame)) return {};
  if (key) {
    list_vertices(frame, initial_, half);
    if (listed_.empty())
      listed_.push_back(is_felt(frame) ? mesh_.triangles[frame.touch->triangle][0] : 0);  // R-MES-12: at least one
  }
  const DeformableState& from = base(key);
  models_ = mesh_.models_kept ? from.models : cold_;
  ThesisHead head = head_for(frame, key);
  head.list_bytes = static_cast<std::uint32_t>(write_list());
  const std::span<std::uint8_t> packet = buffer(half);
  std::size_t at = write_head(head, packet);
  std::copy_n(list_.begin(), head.list_bytes, packet.begin() + static_cast<std::ptrdiff_t>(at));
  at += head.list_bytes;
  next_.displacement = expected_;
  RangeEncoder coder(packet.subspan(at));
  const auto symbols = std::span<BitModel>(models_).subspan(kIndexModels);
  for (const std::uint32_t v : listed_) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::uint32_t symbol = quantise_error(frame.truth[v][axis] - expected_[v][axis], head, mesh_.quant_bits);
      code_symbol(coder, symbols, mesh_.quant_bits, symbol);
      auto& u = next_.displacement[v][axis];
      u = limited_displacement(std::int64_t{u} + restore_error(symbol, head, mesh_.quant_bits));
    }
  }
  if (mesh_.models_kept) next_.models = models_;
  return finish(at + coder.finish(), key, half, frame.tick, head.count);
}

}  // namespace

std::unique_ptr<DeformableEncoderSide> make_thesis_side(const StreamHeader& header, const DeformableObject& mesh,
                                                        const DeformableEncoderOptions& options) {
  return std::make_unique<ThesisSide>(header, mesh, options);
}

}  // namespace tactus
