// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/scene/scene_syntax.h>

namespace tactus {

/// Where and how hard a user touches the mesh at one tick.
struct SurfaceTouch {
  std::uint32_t triangle = 0;  ///< nearest to the virtual proxy: the middle of the area of interest
  double force = 0;            ///< [N] |f_s|, rendered at the server
  double stiffness = 500;      ///< [N/m] k_c of the client's rendering, > 0
};

struct DeformableEncoderOptions {
  DeformableThresholds thresholds;
  double key_interval = 5.0;  ///< [s] after this long the next packet builds on the initial state; 0: only after 8 s of silence
  double visual_share = 1;    ///< main: code to this share of v: less error for more bits. 0.001 <= share <= 1
  double haptic_share = 1;    ///< main: the same of h
  bool split = false;         ///< thesis: packets are haptic or visual halves. main: not looked at, the header's `split` decides
  std::uint16_t first_sequence = 1;  ///< as RigidEncoderOptions
};

struct EncodedDeformablePacket {
  /// Empty: nothing to send, since on the prediction every bound holds for which this half vouches. Valid until the next encode().
  std::span<const std::uint8_t> bytes;
  std::uint32_t updates = 0;  ///< vertices with a residual of their own
  bool key = false;
  Layer half = Layer::all;
};

/// Server side of one mesh: true displacements in, at most one packet per frame out. Split, at most two: what the hand feels goes
/// first, and need not wait until the rest is coded.
///
/// Each packet builds on the one made before it, a haptic half often on the visual half of the frame before. If one does not arrive,
/// the decoder refuses all that follow (R-PKT-4) up to the next key packet. A sender that does without a visual half therefore
///   * does not call encode_rest(), or
///   * drops what that returned and calls forget_last() before the next packet is made, which then builds on the state before. The
///     header's baseline_span must be greater than the number of packets dropped in a row, so at least 2; else each drop costs a key
///     packet;
/// and after a loss that it did not know of it calls request_key().
///
/// A key packet forgets the whole shape: after its haptic half the vertices outside the area of interest are back in the initial
/// state until the visual half arrives (mesh_decoder.h). Where nobody joins or seeks, key_interval 0 saves that.
///
/// Profile main: after every frame the decoder's prediction obeys, for every vertex,
///   |u^ - u| <= v, and <= h = p |f_s| / k_c inside the area of interest,
/// where a bound below the grid's rounding (0.87 units) means: the nearest grid point. After the haptic half of a split frame it does
/// so for the vertices inside the area of interest.
/// Profile thesis sends what reaches its thresholds; its quantiser may leave errors above h (thesis 3.3.1.1).
class DeformableEncoder {
 public:
  /// in   mesh  index into header.meshes
  /// err  invalid R-STR-n, R-MES-n: the header breaks a rule; invalid_argument R-API-4: an option is negative, NaN or too large;
  ///      R-API-5: no such mesh.
  static Result<DeformableEncoder> create(StreamHeader header, std::size_t mesh, const DeformableEncoderOptions& options = {});

  /// Look at one frame and decide. If packets are halves: the haptic one.
  /// in   tick          strictly increasing
  ///      displacement  [m] one per vertex
  /// time O(vertices * (1 + modes)), 100 us for 714 vertices and 48 modes; no allocation, no exception.
  /// err  invalid_argument R-API-1 a displacement or force is not finite; R-API-2 it leaves the grid's range;
  ///      R-API-5 wrong count, tick order, triangle, force or stiffness. State is unchanged after any error.
  Result<EncodedDeformablePacket> encode(std::int64_t tick, std::span<const Vec3> displacement,
                                         const std::optional<SurfaceTouch>& touch = {}) noexcept;

  /// The visual half of the frame that encode() saw last. Without bytes also if packets are not halves.
  /// time as encode(), no allocation
  EncodedDeformablePacket encode_rest() noexcept;

  /// The packet returned last will not arrive (it is dropped, or known to be lost): the next one builds on the state before it, which
  /// the decoder holds, or on the initial state if the header's baseline_span does not reach so far. Only once after each packet.
  void forget_last() noexcept;

  /// The receiver refuses what it gets (R-PKT-4): the next frame brings a key packet, also where every bound holds.
  void request_key() noexcept;

  const StreamHeader& header() const noexcept;
  std::uint64_t state_hash() const noexcept;  ///< equals the decoder's after the same packets

  DeformableEncoder(DeformableEncoder&&) noexcept;
  DeformableEncoder& operator=(DeformableEncoder&&) noexcept;
  ~DeformableEncoder();

 private:
  struct Impl;
  explicit DeformableEncoder(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
