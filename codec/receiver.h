// SPDX-License-Identifier: Apache-2.0
/// The client's side: packets in, a replica out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <tactus/base/result.h>
#include <tactus/client/replica.h>
#include <tactus/packet/packet.h>
#include <tactus/scene/scene.h>

namespace tactus {

struct ReceiverOptions {
  ReplicaOptions replica{};
  DecodeLimits limits{};
};

/// Keeps the newest `baseline_span` states of each substream and nothing else.
///
/// Packets may be lost, repeated, or late by up to 127 packets: each is decoded upon just the state that it was made from, or refused.
/// With a clock (`now`) this holds after outages of any length too: what is too old to be sure of is forgotten, and the next key packet
/// taken, whatever its number and tick; the same when another sender of this scene, or one begun anew, is heard. spec/25-packet.md 4 and 5.
/// What no receiver notices: damaged bytes, for which transport must have a check value; another sender, or one begun anew, if the first
/// packet of it to come is up to 127 numbers before the newest or baseline_span after it; and without a clock an outage of n packets,
/// n mod 65536 < baseline_span or >= 65408.
///
/// Threads: one at a time. The scene is shared. No allocation and no exception after create().
class Receiver {
 public:
  /// err  invalid_argument R-API-4: a replica option; limit_exceeded R-STR-14, R-STR-18 the scene is beyond the limits, R-API-11 memory
  static Result<Receiver> create(SharedScene scene, const ReceiverOptions& options = {});

  /// Decode a packet and show it. After an error everything is what it was before.
  /// in   packet  as Packet::bytes
  ///      now     [ticks] of the receiver's own clock, from any origin, when it arrived. Packets of files need none: there ticks tell
  ///              (R-FIL-7), and each counts as arriving in its tick
  /// out  what to acknowledge: substream and sequence
  /// time < 2 us for one rigid update; 60 us for 714 vertices and 48 modes; no allocation.
  /// err  advice() says what to do about it. truncated, malformed, invalid: R-PKT, R-RIG, R-DEF, R-RNG; limit_exceeded R-PKT-1; state
  ///      R-PKT-5 the packet is not newer than the newest; R-PKT-4 what it builds on is not held: a packet before it is lost or late;
  ///      R-PKT-7 its number is that of another sender or of after a long outage, and baselines are forgotten
  Result<DecodedPacket> push(std::span<const std::uint8_t> packet, std::optional<std::int64_t> now = {}) noexcept;

  /// What the client shows.
  Replica& replica() noexcept;

  const SharedScene& scene() const noexcept;
  /// Newest state of every rigid object, scene order.
  std::span<const RigidState> objects() const noexcept;
  /// Newest decoded displacements of a deformable object, V x 3, x 2^-position_exp m.   pre  object < scene.deformables.size()
  std::span<const std::array<std::int32_t, 3>> displacements(std::size_t object) const noexcept;
  std::int64_t tick(std::size_t substream) const noexcept;         ///< of its newest packet, 0 before the first
  std::uint64_t state_hash(std::size_t substream) const noexcept;  ///< pre  the substream exists

  Receiver(Receiver&&) noexcept;
  Receiver& operator=(Receiver&&) noexcept;
  ~Receiver();

 private:
  struct Impl;
  explicit Receiver(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
