// SPDX-License-Identifier: Apache-2.0
/// One substream at a receiver: accepts packets and finds their baselines. spec/40-rigid.md section 2. Internal to the library.
///
/// A `Codec` knows nothing of sequence numbers, loss or clocks:
///   State                                        has a member tick
///   Result<PacketHead> read_head(payload)        the baseline and the tick
///   Result<void> read_body(base, tick, out)      the rest, into a pending state
///   void commit(base, next)                      writes the pending state to `next`, which may be `base`
///   std::uint64_t bit()                          bit offset of an error in the payload
///   static RuleName kTickRule                    rule broken by a tick that is too large or decreases
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/packet/packet.h>
#include <tactus/packet/substream.h>
#include <tactus/scene/scene.h>

namespace tactus {

template <class Codec>
class SubstreamDecoder {
 public:
  using State = typename Codec::State;

  /// pre  `scene` outlives the decoder
  template <class... Of>
  SubstreamDecoder(const Scene& scene, const DecodeLimits& limits, State initial, Of&&... of)
      : codec_(std::forward<Of>(of)...),
        states_(std::move(initial), scene.baseline_span),
        order_(scene.tick_rate),
        span_(scene.baseline_span),
        limit_(limits.packet_bytes) {}

  /// A packet that carries its number. An error leaves the states unchanged.   err  Receiver::push
  Result<DecodedPacket> decode(std::span<const std::uint8_t> packet, std::optional<std::int64_t> now) noexcept {
    constexpr std::size_t kSequence = 2;
    if (packet.size() > limit_) return fail(Errc::limit_exceeded, "R-PKT-1");
    if (packet.size() < kSequence) return fail(Errc::truncated, "R-PKT-2");
    const auto sequence = static_cast<std::uint16_t>(packet[0] | packet[1] << 8);
    if (order_.outlasts(now)) states_.clear();
    return decode_payload(order_.number_of(sequence, !states_.empty()), packet.subspan(kSequence), now, kSequence);
  }

  /// A packet of a session, which knows its number. An error leaves the states unchanged.   err  Receiver::push_numbered
  Result<DecodedPacket> decode_numbered(std::uint64_t number, std::span<const std::uint8_t> packet) noexcept {
    if (packet.size() > limit_) return fail(Errc::limit_exceeded, "R-PKT-1");
    if (states_.empty()) order_.begin(number);
    return decode_payload(number, packet, {}, 0);
  }

  bool holds(std::uint64_t number) const noexcept { return !states_.empty() && states_.find(number) != nullptr; }
  const State& newest() const noexcept { return states_.newest(); }
  /// The state after a packet.   pre  decode() has just returned it
  const State& after(const DecodedPacket& packet) const noexcept { return *states_.find(packet.number); }
  const State& at(std::int64_t tick) const noexcept { return states_.at(tick); }  ///< BaselineRing::at
  Codec& codec() noexcept { return codec_; }

 private:
  /// in  start  of the payload in the packet [bytes]
  Result<DecodedPacket> decode_payload(std::uint64_t number, std::span<const std::uint8_t> payload,
                                       std::optional<std::int64_t> now, std::size_t start) noexcept {
    const auto placed = [start](const Error& error) noexcept { return fail_at(error, 8 * start + error.bit_offset); };
    DecodedPacket out;
    out.number = number;
    out.sequence = static_cast<std::uint16_t>(number);
    if (order_.is_reordered(out.number) && (out.number < *states_.lowest() || states_.find(out.number) != nullptr))
      return fail(Errc::state, "R-PKT-5");
    const auto head = codec_.read_head(payload);
    if (!head) return placed(head.error());
    TACTUS_TRY(const State* base, baseline_of(*head, out.number));
    out.key = head->key;
    out.baseline = head->key ? 0 : out.number - head->baseline_delta;
    out.tick = base->tick + head->tick_delta;
    if (out.tick >= kTickLimit || !order_.fits(out.number, head->key, out.tick))
      return placed({Errc::invalid, Codec::kTickRule, codec_.bit()});
    if (const auto body = codec_.read_body(*base, out.tick, out); !body) return placed(body.error());
    out.restarts = order_.restarts(out.number, head->key, out.tick);
    if (out.restarts) states_.clear();
    states_.put(out.number, [&](State& next) {
      codec_.commit(*base, next);
      next.tick = out.tick;
    });
    order_.accept(out.number, out.tick, now);
    return out;
  }

  Result<const State*> baseline_of(const PacketHead& head, std::uint64_t number) noexcept {
    if (head.key) return &states_.initial();
    if (head.baseline_delta < 1 || head.baseline_delta > farthest_baseline(span_, order_.is_numbered()))
      return fail(Errc::invalid, "R-PKT-3");
    if (!states_.empty() && order_.is_foreign(number)) {
      states_.clear();
      return fail(Errc::state, "R-PKT-7");
    }
    const State* state = states_.find(number - head.baseline_delta);
    if (state == nullptr) return fail(Errc::state, "R-PKT-4");
    return state;
  }

  Codec codec_;
  BaselineRing<State> states_;
  PacketOrder order_;
  std::uint32_t span_, limit_;
};

}  // namespace tactus
