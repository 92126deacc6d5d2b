// SPDX-License-Identifier: Apache-2.0
/// Decodes payloads of the rigid objects into states: a function of payload and baseline. spec/40-rigid.md sections 3 and 5.
/// Internal to the library; Receiver is the way in.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/packet/packet.h>
#include <tactus/rigid/rigid_states.h>
#include <tactus/rigid/rigid_syntax.h>

namespace tactus {

/// A codec of SubstreamDecoder.
class RigidDecoder {
 public:
  using State = RigidStates;
  static constexpr RuleName kTickRule = "R-RIG-1";

  /// pre  `scene` outlives the decoder
  explicit RigidDecoder(const Scene& scene);

  /// err  malformed R-RNG-4
  Result<PacketHead> read_head(std::span<const std::uint8_t> payload) noexcept;
  /// time O(updates), < 2 us for one; no allocation.   err  malformed R-RNG-n; invalid R-RIG-3, R-RIG-4, R-RIG-6, R-RIG-7
  Result<void> read_body(const RigidStates& base, std::int64_t tick, DecodedPacket& out) noexcept;
  /// time O(updates), and O(objects / 8) where `next` is not `base`
  void commit(const RigidStates& base, RigidStates& next) noexcept;
  std::uint64_t bit() const noexcept { return 8 * std::min<std::uint64_t>(coder_.position(), payload_); }

 private:
  Result<void> read_updates(const RigidStates& base, std::int64_t tick) noexcept;

  const Scene& scene_;
  RigidPredictor predictor_;
  RangeDecoder coder_{{}};
  std::uint64_t payload_ = 0;  // [bytes]
  RigidModels models_;
  RigidHead head_;
  std::vector<RigidUpdate> updates_;  // pending: no state changes before the whole packet has proved valid
  std::vector<RigidState> states_;
};

}  // namespace tactus
