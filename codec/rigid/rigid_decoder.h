// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "codec/base/result.h"
#include "codec/rigid/rigid.h"
#include "codec/stream/header.h"

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
class RigidDecoder {
 public:
  /// err  invalid R-STR-n (the header breaks a rule), limit_exceeded R-STR-14.
  static Result<RigidDecoder> create(StreamHeader header, const DecodeLimits& limits = {});

  /// Decode one packet. After an error the state is what it was before.
  /// time O(updates + objects if baseline_span > 1), < 2 us for one update; no allocation, no exception.
  /// err  truncated, malformed, invalid: R-RIG-n; limit_exceeded R-PKT-1; state: R-PKT-5 the packet is not newer than the newest one:
  ///      drop it; R-PKT-4 what it builds on is not held, a packet before it is lost or late: ask the sender for a key packet
  ///      (RigidEncoder::request_key), before which others may be refused.
  Result<DecodedPacket> decode(std::span<const std::uint8_t> packet) noexcept;

  /// Newest state of every object, header order.
  std::span<const RigidState> objects() const noexcept;
  const StreamHeader& header() const noexcept;
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
