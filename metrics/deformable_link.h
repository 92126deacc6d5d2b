// SPDX-License-Identifier: Apache-2.0
/// Meshes from a trace to a stream: how they are coded, one mesh's way from server to client, and what it cost.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/deformable/decoder.h>
#include <tactus/deformable/encoder.h>
#include <tactus/trace/frame.h>

namespace tactus {

/// What a stream's header says of how its meshes are coded. spec/60-mesh.md section 2.
struct DeformableCoding {
  DeformableProfile profile = DeformableProfile::main;
  std::uint8_t rings = DeformableObject{}.rings;
  std::uint8_t quant_bits = DeformableObject{}.quant_bits;         ///< thesis
  bool models_kept = DeformableObject{}.models_kept;               ///< thesis
  bool split = DeformableObject{}.split;                           ///< main; of thesis the encoder alone knows
  std::function<Result<ModeBasis>(const TraceDeformable&)> basis;  ///< main: makes each mesh's basis; empty: without
};

/// A mesh for a stream header, its frame period that of the trace.
/// err  invalid_argument R-API-1, R-API-2 as make_deformable_object(), R-API-10 a triangle has no area on the grid; those of the basis
Result<DeformableObject> deformable_object(const TraceDeformable& mesh, const DeformableCoding& coding, unsigned position_exp);

/// Who touches this mesh: of several users the one who presses least, whose haptic threshold is the lowest.
/// out  force is that of the coupling, k |x_p - x_d|
std::optional<SurfaceTouch> touch_of(const TraceFrame& frame, std::size_t mesh) noexcept;

/// What one shape takes, in the order of sending. Those without bytes are not needed; only split meshes have a second one.
using DeformablePackets = std::array<EncodedDeformablePacket, 2>;

/// One mesh from server to client: shapes in, packets through an encoder and a decoder, what the client shows out.
class DeformableLink {
 public:
  /// in   mesh  index into header.meshes
  /// err  as DeformableEncoder::create and DeformableDecoder::create
  static Result<DeformableLink> create(const StreamHeader& header, std::size_t mesh, const DeformableEncoderOptions& options);

  /// Server: look at one shape.   in  displacements  [m] x y z of vertex 0 first
  /// out  as DeformableEncoder::encode and encode_rest; without the number of the part.   no allocation
  Result<DeformablePackets> encode(std::int64_t tick, std::span<const float> displacements,
                                   const std::optional<SurfaceTouch>& touch) noexcept;
  /// Client: decode a packet that encode() returned.   err  as DeformableDecoder::decode; no allocation
  Result<DecodedDeformablePacket> decode(std::span<const std::uint8_t> packet) noexcept { return decoder_.decode(packet); }
  /// Client: displacements [m] at a tick, one per vertex. Valid until the next call.   no allocation
  std::span<const Vec3> shown(std::int64_t tick) noexcept;

 private:
  DeformableLink(DeformableEncoder encoder, DeformableDecoder decoder, std::size_t vertices, unsigned position_exp)
      : encoder_(std::move(encoder)), decoder_(std::move(decoder)), vectors_(vertices), position_exp_(position_exp) {}

  DeformableEncoder encoder_;
  DeformableDecoder decoder_;
  std::vector<Vec3> vectors_;
  unsigned position_exp_;
};

/// What was sent of one mesh.
struct DeformableRates {
  std::uint64_t frames = 0;          ///< shapes looked at; 0: not known
  std::uint64_t updates = 0;         ///< vertices with a residual of their own
  std::uint64_t keys = 0;            ///< key packets
  std::uint64_t bytes = 0;           ///< of packets, with their part numbers, without any header below them
  std::vector<std::uint32_t> sizes;  ///< of every packet [bytes]
  struct Half {
    std::uint64_t packets = 0, bytes = 0;
  };
  std::array<Half, 2> halves{};  ///< index: Layer; of packets known to be halves

  void add(std::size_t packet_bytes, std::uint64_t update_count, bool key, Layer half);
  std::uint32_t quantile(double share) const;  ///< of the packets' sizes [bytes]; 1: the largest, 0 without packets
};

}  // namespace tactus
