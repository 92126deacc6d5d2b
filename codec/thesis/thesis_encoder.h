// SPDX-License-Identifier: Apache-2.0
/// Meshes of profile thesis: codes true displacements of one object into payloads, a function of truth and baseline. It codes the errors
/// that reach the thresholds; its quantiser may leave errors above h. Internal to the library; Sender is the way in.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <tactus/deformable/deformable_encoder.h>
#include <tactus/deformable/displacement.h>
#include <tactus/mesh/graph.h>
#include <tactus/packet/substream_encoder.h>
#include <tactus/thesis/thesis_syntax.h>

namespace tactus {

/// A codec of SubstreamEncoder.
class ThesisEncoder {
 public:
  using State = ThesisState;

  /// pre  `scene` outlives the encoder
  ThesisEncoder(const Scene& scene, const DeformableObject& object, const DeformableOptions& options);

  /// The truth of one frame, on the grid.   pre  both live until the last encode() of the frame
  void read(std::span<const Vec3i> truth, const SurfaceTouch* touch) noexcept {
    truth_ = truth;
    touch_ = touch;
  }
  void set_bound_scale(double factor) noexcept { bound_scale_ = factor; }
  /// time O(vertices), no allocation
  Result<Payload> encode(const EncodeRequest<ThesisState>& request, std::span<std::uint8_t> out) noexcept;
  void commit(const ThesisState&, ThesisState& next) noexcept { std::swap(next_, next); }

 private:
  bool has_haptic_bound() const noexcept { return touch_ != nullptr && options_.thresholds.weber_fraction; }
  void list_vertices(const ThesisState& state, Layer layer) noexcept;
  ThesisHead head_for(const PacketHead& head) const noexcept;
  std::size_t write_head(const ThesisHead& head, std::span<std::uint8_t> out) const noexcept;
  std::size_t write_list() noexcept;

  const DeformableObject& object_;
  const DeformableOptions options_;
  double bound_scale_ = 1;
  std::uint8_t position_exp_, baseline_span_;
  std::span<const Vec3i> truth_;
  const SurfaceTouch* touch_ = nullptr;
  Rings rings_;
  ThesisState next_;  // pending until commit()
  std::vector<BitModel> start_, models_;
  std::vector<Vec3i> expected_;        // of the baseline
  std::vector<std::uint8_t> list_;     // the coded index list
  std::vector<std::uint32_t> listed_;  // vertices of the packet at hand
  std::vector<std::uint8_t> inside_;   // in the area of interest
};

/// DeformableEncoder::create of an object of profile thesis
std::unique_ptr<DeformableEncoder> thesis_mesh_encoder(const Scene& scene, std::size_t object, const DeformableOptions& options,
                                                       const SenderPolicy& policy);
/// Without its substream's number [bytes]
std::size_t largest_thesis_packet(const DeformableObject& object) noexcept;

}  // namespace tactus
