// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "codec/mesh/mesh_encoder_side.h"
#include "codec/mesh/mesh_thesis.h"

namespace tactus {
namespace {

class ThesisSide : public MeshEncoderSide {
 public:
  ThesisSide(const StreamHeader& header, const MeshObject& mesh, const MeshEncoderOptions& options)
      : MeshEncoderSide(header, mesh, options),
        cold_(cold_thesis_models(mesh)),
        models_(cold_),
        list_(max_mesh_packet_size(mesh)) {
    listed_.reserve(mesh.rest.size());
  }
  EncodedMeshPacket encode(const MeshFrame& frame) noexcept override;

 private:
  void list_vertices(const MeshFrame& frame) noexcept;
  ThesisHead head_for(const MeshFrame& frame, bool key) const noexcept;
  std::size_t write_head(const ThesisHead& head) noexcept;
  std::size_t write_list() noexcept;

  std::vector<BitModel> cold_, models_;
  std::vector<std::uint8_t> list_;     // the coded index list
  std::vector<std::uint32_t> listed_;  // vertices of the packet at hand
};

/// Eqs. 3.10 and 3.11: an error that reaches a threshold includes the vertex. Ascending order.
void ThesisSide::list_vertices(const MeshFrame& frame) noexcept {
  const MeshThresholds& t = options_.thresholds;
  const auto squared_units = [this](double metres) {
    const double units = std::ldexp(metres, header_.grid.position);
    return units * units;
  };
  const double visual = squared_units(t.visual);
  const auto error = [&](std::uint32_t v) { return static_cast<double>(squared_distance(frame.truth[v], expected_[v])); };
  listed_.clear();
  for (std::uint32_t v = 0; v < frame.truth.size(); ++v)
    if (error(v) >= visual) listed_.push_back(v);
  if (!frame.touch || !t.weber_fraction) return;
  const double haptic = squared_units(haptic_threshold(t, *frame.touch));
  if (haptic >= visual) return;
  for (const std::uint32_t v : area(frame.touch->triangle))
    if (error(v) >= haptic && error(v) < visual) listed_.push_back(v);
  std::sort(listed_.begin(), listed_.end());
}

ThesisHead ThesisSide::head_for(const MeshFrame& frame, bool key) const noexcept {
  ThesisHead head;
  head.key = key;
  head.tick_delta = static_cast<std::uint32_t>(frame.tick - base(key).tick);
  head.count = static_cast<std::uint32_t>(listed_.size());
  std::int32_t low = MeshObject::kMaxDisplacement * 2, high = -low;
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
std::size_t ThesisSide::write_head(const ThesisHead& head) noexcept {
  std::size_t at = 2;
  const auto varint = [&](std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) buffer_[at++] = static_cast<std::uint8_t>(value | 0x80);
    buffer_[at++] = static_cast<std::uint8_t>(value);
  };
  buffer_[at++] = head.key ? 1 : 0;
  if (!head.key && header_.baseline_span > 1) buffer_[at++] = head.baseline_delta;
  varint(head.tick_delta);
  varint(head.count);
  varint(head.list_bytes);
  varint(static_cast<std::uint32_t>(head.lowest) << 1 ^ static_cast<std::uint32_t>(head.lowest >> 31));
  varint(head.range);
  return at;
}

EncodedMeshPacket ThesisSide::encode(const MeshFrame& frame) noexcept {
  expected_ = held_.displacement;
  list_vertices(frame);
  if (listed_.empty()) return {};
  const bool key = key_due(frame.tick);
  if (key) {
    expected_ = initial_.displacement;
    list_vertices(frame);
  }
  const MeshState& from = base(key);
  models_ = mesh_.models_kept ? from.models : cold_;
  ThesisHead head = head_for(frame, key);
  head.list_bytes = static_cast<std::uint32_t>(write_list());
  std::size_t at = write_head(head);
  std::copy_n(list_.begin(), head.list_bytes, buffer_.begin() + static_cast<std::ptrdiff_t>(at));
  at += head.list_bytes;
  next_.displacement = expected_;
  RangeEncoder coder(std::span<std::uint8_t>(buffer_).subspan(at));
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
  return finish(at + coder.finish(), key, frame.tick, head.count);
}

}  // namespace

std::unique_ptr<MeshEncoderSide> make_thesis_side(const StreamHeader& header, const MeshObject& mesh,
                                                  const MeshEncoderOptions& options) {
  return std::make_unique<ThesisSide>(header, mesh, options);
}

}  // namespace tactus
