// SPDX-License-Identifier: Apache-2.0
/// The substream of one deformable object at a sender, whatever its profile. Internal to the library; Sender is the way in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include <tactus/base/result.h>
#include <tactus/deformable/trigger.h>
#include <tactus/packet/packet.h>
#include <tactus/packet/sender_policy.h>
#include <tactus/scene/deformable_object.h>
#include <tactus/scene/scene.h>

namespace tactus {

class FollowedShape;

/// Largest packet of an object, without the number of its substream [bytes].
std::size_t max_packet(const DeformableObject& object) noexcept;

class DeformableEncoder {
 public:
  /// R-API-4: an option is negative, NaN or too large.
  static Result<void> check(const DeformableOptions& options) noexcept;
  /// The one place that chooses by profile.   pre  check(), object < scene.deformables.size(), and `scene` outlives the encoder
  static std::unique_ptr<DeformableEncoder> create(const Scene& scene, std::size_t object, const DeformableOptions& options,
                                                   const SenderPolicy& policy);
  virtual ~DeformableEncoder() = default;

  /// Take the truth of one frame; changes nothing else.   pre  there are displacements.   in, err  Sender::encode
  virtual Result<void> read(const DeformableTruth& truth) noexcept = 0;
  /// Code one packet of the frame. A layered object takes its haptic layer first, then the visual one; others take Layer::all.
  /// Returns a packet without bytes if none is needed.
  /// in   number  as in SubstreamEncoder::encode
  virtual Packet encode(std::int64_t tick, Layer layer, std::optional<std::uint64_t> number) noexcept = 0;
  virtual bool is_layered() const noexcept = 0;
  virtual void set_link(const LinkState& link) noexcept = 0;  ///< nothing without Baseline::acknowledged, or with layers
  virtual void set_widening(double factor) noexcept = 0;      ///< of all thresholds.   pre  factor >= 1
  /// Show what the device of the client does (Sender::know).   pre  the object has a body
  virtual void know(std::unique_ptr<FollowedShape> shape) noexcept = 0;
  virtual void request_key() noexcept = 0;
  virtual void forget_last() noexcept = 0;
  virtual void acknowledge(std::uint16_t sequence) noexcept = 0;
  virtual std::uint64_t state_hash() const noexcept = 0;
};

}  // namespace tactus
