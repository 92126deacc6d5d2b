// SPDX-License-Identifier: Apache-2.0
#include <tactus/thesis/thesis_encoder.h>

#include <algorithm>
#include <cmath>

#include <tactus/base/bytes.h>

namespace tactus {

ThesisEncoder::ThesisEncoder(const Scene& scene, const DeformableObject& object, const DeformableOptions& options)
    : object_(object),
      options_(options),
      position_exp_(scene.grid.position),
      baseline_span_(scene.baseline_span),
      rings_(object),
      next_(initial_thesis_state(object)),
      start_(initial_thesis_models(object)),
      models_(start_),
      expected_(object.rest.size()),
      list_(max_thesis_packet(object.rest.size(), object.quant_bits)),
      inside_(object.rest.size()) {
  listed_.reserve(object.rest.size());
}

/// Eqs. 3.10 and 3.11: an error against `state` that reaches a threshold includes the vertex. Ascending order.
void ThesisEncoder::list_vertices(const ThesisState& state, Layer layer) noexcept {
  const DeformableThresholds& t = options_.thresholds;
  const auto squared_units = [this](double metres) {
    const double units = std::ldexp(bound_scale_ * metres, position_exp_);
    return units * units;
  };
  const double visual = squared_units(t.visual);
  double haptic = visual;
  std::span<const std::uint32_t> touched;
  if (has_haptic_bound()) {
    haptic = std::min(visual, squared_units(haptic_threshold(t, *touch_)));
    rings_.triangles_around(touch_->triangle, object_.rings);
    touched = rings_.vertices();
  }
  for (const std::uint32_t v : touched) inside_[v] = 1;
  expected_ = state.displacement;
  listed_.clear();
  for (std::uint32_t v = 0; v < truth_.size(); ++v) {
    const bool inside = inside_[v] != 0;
    if (layer == (inside ? Layer::visual : Layer::haptic)) continue;
    if (static_cast<double>(squared_distance(truth_[v], expected_[v])) >= (inside ? haptic : visual)) listed_.push_back(v);
  }
  for (const std::uint32_t v : touched) inside_[v] = 0;
}

ThesisHead ThesisEncoder::head_for(const PacketHead& head) const noexcept {
  std::int32_t low = DeformableObject::kMaxDisplacement * 2, high = -low;
  for (const std::uint32_t v : listed_) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int32_t e = truth_[v][axis] - expected_[v][axis];
      low = std::min(low, e);
      high = std::max(high, e);
    }
  }
  ThesisHead out{head};
  out.count = static_cast<std::uint32_t>(listed_.size());
  out.lowest = low;
  out.range = static_cast<std::uint32_t>(high - low);
  return out;
}

std::size_t ThesisEncoder::write_list() noexcept {
  RangeEncoder coder(list_);
  std::uint32_t at = 0;
  for (const std::uint32_t v : listed_) {
    code_gap(coder, models_, v - at, 0xfffffffe);
    at = v + 1;
  }
  return coder.finish();
}

/// Everything before the index list; returns where the list begins.
std::size_t ThesisEncoder::write_head(const ThesisHead& head, std::span<std::uint8_t> out) const noexcept {
  std::size_t at = 0;
  const auto varint = [&](std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) out[at++] = static_cast<std::uint8_t>(value | 0x80);
    out[at++] = static_cast<std::uint8_t>(value);
  };
  out[at++] = head.key ? 1 : 0;
  if (!head.key && baseline_span_ > 1) varint(head.baseline_delta);
  varint(head.tick_delta);
  varint(head.count);
  varint(head.list_bytes);
  varint(zigzag(head.lowest));
  varint(head.range);
  return at;
}

Result<Payload> ThesisEncoder::encode(const EncodeRequest<ThesisState>& request, std::span<std::uint8_t> out) noexcept {
  const bool key = request.head.key;
  if (request.layer == Layer::haptic && !has_haptic_bound()) return Payload{};
  list_vertices(request.shown, key ? Layer::all : request.layer);  // a key packet forgets the whole shape
  if (listed_.empty() && !request.requested) return Payload{};
  // What is rendered goes first: a key packet of the rest alone would forget it.
  if (request.layer == Layer::visual && key && has_haptic_bound()) return Payload{};
  if (key || &request.base != &request.shown) {
    list_vertices(request.base, request.layer);
    if (listed_.empty())
      listed_.push_back(has_haptic_bound() ? object_.triangles[touch_->triangle][0] : 0);  // R-DEF-12: at least one
  }
  models_ = object_.models_kept ? request.base.models : start_;
  ThesisHead head = head_for(request.head);
  head.list_bytes = static_cast<std::uint32_t>(write_list());
  std::size_t at = write_head(head, out);
  std::copy_n(list_.begin(), head.list_bytes, out.begin() + static_cast<std::ptrdiff_t>(at));
  at += head.list_bytes;
  next_.displacement = expected_;
  RangeEncoder coder(out.subspan(at));
  const auto symbols = std::span<BitModel>(models_).subspan(kIndexModels);
  for (const std::uint32_t v : listed_) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::uint32_t symbol = quantise_error(truth_[v][axis] - expected_[v][axis], head, object_.quant_bits);
      code_symbol(coder, symbols, object_.quant_bits, symbol);
      auto& u = next_.displacement[v][axis];
      u = limited_displacement(std::int64_t{u} + restore_error(symbol, head, object_.quant_bits));
    }
  }
  if (object_.models_kept) next_.models = models_;
  return Payload{.size = at + coder.finish(), .updates = head.count};
}

std::unique_ptr<DeformableEncoder> thesis_mesh_encoder(const Scene& scene, std::size_t object, const DeformableOptions& options,
                                                       const SenderPolicy& policy) {
  const DeformableObject& o = scene.deformables[object];
  return std::make_unique<DeformableEncoderOf<ThesisEncoder>>(scene, object, options, policy, largest_thesis_packet(o), o.layered,
                                                              initial_thesis_state(o));
}

std::size_t largest_thesis_packet(const DeformableObject& object) noexcept {
  return max_thesis_packet(object.rest.size(), object.quant_bits);
}

}  // namespace tactus
