// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <tactus/base/result.h>
#include <tactus/scene/scene_syntax.h>

namespace tactus {

struct DecodedDeformablePacket {
  std::uint16_t sequence = 0;
  bool key = false;         ///< built on the initial state
  Layer half = Layer::all;  ///< main; packets of profile thesis do not say it
  std::int64_t tick = 0;
  std::uint32_t updates = 0;      ///< vertices with a residual of their own
  std::uint32_t final_range = 0;  ///< range decoder's state after the last symbol (conformance); thesis: of the displacements
  std::uint32_t final_code = 0;
};

/// Client side of one mesh: packets in, integer displacements out. Keeps the newest `baseline_span` states. What it makes of lost, late
/// and foreign packets is told at RigidDecoder.
///
/// After a haptic half that is a key packet, all vertices outside the area of interest are where the initial state has them. Show
/// them as before until a visual half has arrived, or the whole shape falls flat for as long as that takes.
class DeformableDecoder {
 public:
  using Displacement = std::array<std::int32_t, 3>;  ///< x 2^-position_exp m

  /// in   mesh  index into header.meshes
  /// err  invalid R-STR-n, R-MES-n (the header breaks a rule), limit_exceeded R-STR-14, R-STR-18; invalid_argument R-API-5: no such mesh.
  static Result<DeformableDecoder> create(const StreamHeader& header, std::size_t mesh, const DecodeLimits& limits = {});

  /// Decode one packet. After an error the state is what it was before.
  /// in   now  [ticks] of the receiver's own clock when the packet arrived, as in RigidDecoder::decode
  /// time O(vertices * (1 + modes)), 60 us for 714 vertices and 48 modes; no allocation, no exception.
  /// err  truncated, malformed, invalid: R-MES-n, R-RNG-n; limit_exceeded R-PKT-1; state: R-PKT-5 the packet is not newer than the
  ///      newest one: drop it; R-PKT-4, R-PKT-7 what it builds on is not held: ask the sender for a key packet
  ///      (DeformableEncoder::request_key), before which others may be refused.
  Result<DecodedDeformablePacket> decode(std::span<const std::uint8_t> packet, std::optional<std::int64_t> now = {}) noexcept;

  /// Newest decoded displacement of every vertex.
  std::span<const Displacement> displacements() const noexcept;
  /// Where prediction puts the vertices at a tick; one before the newest packet's counts as that. Valid until the next call.
  std::span<const Displacement> displacements_at(std::int64_t tick) noexcept;
  std::int64_t tick() const noexcept;  ///< of the newest packet, 0 before the first
  std::uint64_t state_hash() const noexcept;

  DeformableDecoder(DeformableDecoder&&) noexcept;
  DeformableDecoder& operator=(DeformableDecoder&&) noexcept;
  ~DeformableDecoder();

 private:
  struct Impl;
  explicit DeformableDecoder(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
