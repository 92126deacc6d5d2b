// SPDX-License-Identifier: Apache-2.0
/// The substream of one deformable object at a receiver, whatever its profile. Internal to the library; Receiver is the way in.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <tactus/base/result.h>
#include <tactus/packet/packet.h>
#include <tactus/scene/scene.h>

namespace tactus {

class FollowedShape;

class DeformableDecoder {
 public:
  /// The one place that chooses by profile.   pre  object < scene.deformables.size(), and `scene` outlives the decoder
  static std::unique_ptr<DeformableDecoder> create(const Scene& scene, std::size_t object, const DecodeLimits& limits);
  virtual ~DeformableDecoder() = default;

  /// in, err  Receiver::push
  virtual Result<DecodedPacket> decode(std::span<const std::uint8_t> packet, std::optional<std::int64_t> now) noexcept = 0;
  /// in, err  Receiver::push_numbered
  virtual Result<DecodedPacket> decode_numbered(std::uint64_t number, std::span<const std::uint8_t> packet) noexcept = 0;
  /// Newest decoded displacement of every vertex, x 2^-position_exp m.
  virtual std::span<const std::array<std::int32_t, 3>> displacements() const noexcept = 0;
  /// Predicted displacements at a tick; a tick before the newest packet counts as that packet's. Valid until the next call.
  virtual std::span<const std::array<std::int32_t, 3>> displacements_at(std::int64_t tick) noexcept = 0;
  /// The same from the newest state held that is not later than the tick, for a client that shows the past. spec/60-client.md 6
  virtual std::span<const std::array<std::int32_t, 3>> displacements_of(std::int64_t tick) noexcept = 0;
  /// Show what the device of the client does (Receiver::know).   pre  the object has a body
  virtual void know(std::unique_ptr<FollowedShape> shape) noexcept = 0;
  virtual bool holds(std::uint64_t number) const noexcept = 0;  ///< the state after the packet of this number
  virtual std::int64_t tick() const noexcept = 0;               ///< of the newest packet, 0 before the first
  virtual std::uint64_t state_hash() const noexcept = 0;
};

}  // namespace tactus
