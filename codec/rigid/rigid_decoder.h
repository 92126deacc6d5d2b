// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <tactus/base/result.h>
#include <tactus/rigid/rigid.h>
#include <tactus/scene/scene_syntax.h>

namespace tactus {

/// One object in a packet.
struct RigidUpdate {
  std::uint32_t object = 0;  ///< index into StreamHeader::objects
  Reason reason = Reason::request;
  std::uint8_t level = 0;  ///< grid level: residuals were multiples of 4^level grid units
};

struct DecodedPacket {
  std::uint16_t sequence = 0;
  bool key = false;  ///< built on the initial state
  std::int64_t tick = 0;
  std::span<const RigidUpdate> updates;  ///< valid until the next call
  std::uint32_t final_range = 0;         ///< range decoder's state after the last symbol (conformance)
  std::uint32_t final_code = 0;
};

/// Client side: packets in, integer object states out. Keeps the newest `baseline_span` states and nothing else.
///
/// Packets may be lost, repeated, or late by up to 127 packets: each is decoded upon just the state that it was made from, or refused.
/// With a clock (`now`) this holds after outages of any length too: what is too old to be sure of is forgotten, and the next key packet
/// taken, whatever its number and tick; the same when another sender with this header, or one begun anew, is heard. spec/40-rigid.md 2.1.
/// What no receiver notices: damaged bytes, for which transport must have a check value; another sender, or one begun anew, if the first
/// packet of it to come is up to 127 numbers before the newest or baseline_span after it; and without a clock an outage of n packets,
/// n mod 65536 < baseline_span or >= 65408.
class RigidDecoder {
 public:
  /// err  invalid R-STR-n (the header breaks a rule), limit_exceeded R-STR-14, R-STR-18.
  static Result<RigidDecoder> create(const StreamHeader& header, const DecodeLimits& limits = {});

  /// Decode one packet. After an error the state is what it was before.
  /// in   now  [ticks] of the receiver's own clock, from any origin, when the packet arrived. Packets of files need none: there ticks
  ///           tell (R-FIL-7)
  /// time O(updates + objects if baseline_span > 1), < 2 us for one update; no allocation, no exception.
  /// err  truncated, malformed, invalid: R-RIG-n; limit_exceeded R-PKT-1; state: R-PKT-5 the packet is not newer than the newest one:
  ///      drop it; R-PKT-4 what it builds on is not held, a packet before it is lost or late, or R-PKT-7 its number is that of another
  ///      sender or of after a long outage, and the decoder forgets its baselines: ask the sender for a key packet
  ///      (RigidEncoder::request_key), before which others may be refused.
  Result<DecodedPacket> decode(std::span<const std::uint8_t> packet, std::optional<std::int64_t> now = {}) noexcept;

  /// Newest state of every object, header order.
  std::span<const RigidState> objects() const noexcept;
  const StreamHeader& header() const noexcept;  ///< without meshes
  std::uint64_t state_hash() const noexcept;

  RigidDecoder(RigidDecoder&&) noexcept;
  RigidDecoder& operator=(RigidDecoder&&) noexcept;
  ~RigidDecoder();

 private:
  struct Impl;
  explicit RigidDecoder(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
