// SPDX-License-Identifier: Apache-2.0
/// One substream at a receiver: accepts packets and finds their baselines. spec/25-packet.md. Internal to the library.
///
/// A `Codec` knows nothing of numbers and loss:
///   State                                        has a member tick
///   Result<PacketHead> read_head(payload)        the baseline and the tick
///   Result<void> read_body(base, tick, out)      the rest, into a pending state
///   void commit(base, next)                      writes the pending state to `next`, which may be `base`
///   std::uint64_t bit()                          bit offset of an error in the payload
///   static RuleName kTickRule                    rule broken by a tick that is too large or decreases
#pragma once

#include <cstdint>
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
        span_(scene.baseline_span),
        limit_(limits.packet_bytes) {}

  /// An error leaves the states unchanged.   in  number  pre  is_number()   err  Receiver::push
  Result<DecodedPacket> decode(std::uint64_t number, std::span<const std::uint8_t> packet) noexcept {
    if (packet.size() > limit_) return fail(Errc::limit_exceeded, "R-PKT-1");
    DecodedPacket out;
    out.number = number;
    if (number <= newest_ && (number < *states_.lowest() || states_.find(number) != nullptr)) return fail(Errc::state, "R-PKT-5");
    TACTUS_TRY(const PacketHead head, codec_.read_head(packet));
    TACTUS_TRY(const State* base, baseline_of(head, number));
    out.key = head.key;
    out.baseline = head.key ? 0 : number - head.baseline_delta;
    out.tick = base->tick + head.tick_delta;
    if (out.tick >= kTickLimit || !fits(number, out.tick)) return fail(Errc::invalid, Codec::kTickRule, codec_.bit());
    TACTUS_CHECK(codec_.read_body(*base, out.tick, out));
    states_.put(number, [&](State& next) {
      codec_.commit(*base, next);
      next.tick = out.tick;
    });
    newest_ = newest_ > number ? newest_ : number;
    return out;
  }

  bool holds(std::uint64_t number) const noexcept { return states_.find(number) != nullptr; }
  const State& newest() const noexcept { return states_.newest(); }
  /// The state after a packet.   pre  decode() has just returned it
  const State& after(const DecodedPacket& packet) const noexcept { return *states_.find(packet.number); }
  const State& at(std::int64_t tick) const noexcept { return states_.at(tick); }  ///< BaselineRing::at
  Codec& codec() noexcept { return codec_; }

 private:
  /// Ticks do not fall as numbers rise.
  bool fits(std::uint64_t number, std::int64_t tick) const noexcept {
    return number <= newest_ ? tick <= states_.newest().tick : tick >= states_.newest().tick;
  }

  Result<const State*> baseline_of(const PacketHead& head, std::uint64_t number) noexcept {
    if (head.key) return &states_.initial();
    if (head.baseline_delta < 1 || head.baseline_delta > farthest_baseline(span_)) return fail(Errc::invalid, "R-PKT-3");
    const State* state = states_.find(number - head.baseline_delta);
    if (state == nullptr) return fail(Errc::state, "R-PKT-4");
    return state;
  }

  Codec codec_;
  BaselineRing<State> states_;
  std::uint64_t newest_ = 0;  // highest number accepted
  std::uint32_t span_, limit_;
};

}  // namespace tactus
