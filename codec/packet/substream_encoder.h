// SPDX-License-Identifier: Apache-2.0
/// The sender's side of a substream: when key packets go, and on what a packet builds. Internal to the library.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/base/untouched.h>
#include <tactus/packet/packet.h>
#include <tactus/packet/sender_policy.h>
#include <tactus/packet/substream.h>

namespace tactus {

// ==== key policy ====
// When a sender codes a key packet. Informative: a choice of the encoder.

class KeyPolicy {
 public:
  /// in   interval  [s] between key packets; 0: only the necessary ones
  KeyPolicy(double interval, std::uint32_t tick_rate) noexcept
      : interval_(static_cast<std::int64_t>(std::ceil(interval * tick_rate))) {}

  /// True for the first packet, once per interval, and on request.
  bool is_due(std::int64_t tick) const noexcept {
    return requested_ || key_tick_ < 0 || (interval_ > 0 && tick - key_tick_ >= interval_);
  }
  void request() noexcept { requested_ = true; }
  /// True if the next packet must be sent even if every bound holds.
  bool is_requested() const noexcept { return requested_; }
  void sent(std::int64_t tick, bool key) noexcept {
    requested_ = false;
    if (key) key_tick_ = tick;
  }

 private:
  std::int64_t interval_;
  std::int64_t key_tick_ = -1;  // of the last key packet; -1: none yet
  bool requested_ = false;
};

// ==== substream encoder ====
// One substream at a sender: numbers, key packets, and the state that each packet builds on.
//
// A `Codec` knows nothing of baselines, loss or acknowledgements:
//   State                                            has a member tick
//   Result<Payload> encode(request, out)             a payload in `out` if one is needed, and the pending state after it
//   void commit(base, next)                          writes the pending state to `next`, which may be `base`
// and, if it wants to know what receivers may lack:
//   void acknowledge(number)                         the receiver holds the state after this packet
//   void forget_last()                               the last packet was never sent

template <class State>
struct EncodeRequest {
  std::int64_t tick = 0;
  std::uint64_t number = 0;  ///< of the packet
  PacketHead head;           ///< without the tick
  bool requested = false;    ///< a packet is required even if every bound holds
  Layer layer = Layer::all;
  const State& shown;  ///< state of a receiver that got every packet; bounds are checked against it
  const State& base;   ///< baseline of the payload
};

struct Payload {
  std::size_t size = 0;  ///< 0: nothing to send
  Reason reason = Reason::request;
  std::uint32_t updates = 0;
};

template <class Codec>
class SubstreamEncoder {
 public:
  using State = typename Codec::State;

  /// in   substream  its number, written before each packet if there are several
  ///      largest    packet without that number [bytes];  layers  packets per tick
  template <class... Of>
  SubstreamEncoder(const Scene& scene, const SenderPolicy& policy, std::size_t substream, std::size_t largest, std::size_t layers,
                   State initial, Of&&... of)
      : codec_(std::forward<Of>(of)...),
        states_(std::move(initial),
                policy.baseline == Baseline::acknowledged ? std::max<std::size_t>(2, scene.baseline_span) : 2),
        key_(policy.key_interval, scene.tick_rate),
        baseline_(policy.baseline),
        span_(scene.baseline_span),
        substream_(substream),
        start_(has_substream_number(scene) ? 1 : 0) {
    for (std::size_t i = 0; i < layers; ++i) {
      buffers_.emplace_back(start_ + largest);
      buffers_.back()[0] = static_cast<std::uint8_t>(substream);
    }
  }

  /// in   number  of the packet, above all before; without: one more than that of the packet before
  /// out  a packet without bytes: no packet is needed
  Result<Packet> encode(std::int64_t tick, Layer layer, std::optional<std::uint64_t> number = {}) noexcept {
    const std::uint64_t mine = number.value_or(next_);
    const State* base = key_.is_due(tick) ? nullptr : baseline_of(mine);
    PacketHead head{base == nullptr, static_cast<std::uint32_t>(mine - base_), 0};
    if (head.key) base = &states_.initial();
    head.tick_delta = static_cast<std::uint32_t>(tick - base->tick);
    UntouchedBytes& buffer = buffers_[layer == Layer::visual ? 1 : 0];
    TACTUS_TRY(const Payload payload,
               codec_.encode({tick, mine, head, key_.is_requested() || is_overdue(tick), layer, states_.newest(), *base},
                             std::span(buffer).subspan(start_)));
    if (payload.size == 0) return Packet{};
    before_ = {key_, base_};
    repeats_ = is_overdue(tick) ? std::min(repeats_ + 1, kMostRepeats) : 0;
    newest_ = mine;
    next_ = mine + 1;
    states_.put(mine, [&](State& next) {
      codec_.commit(*base, next);
      next.tick = tick;
    });
    key_.sent(tick, head.key);
    if (baseline_ == Baseline::previous) base_ = mine;
    can_forget_ = true;
    return Packet{.bytes = std::span<const std::uint8_t>(buffer).first(start_ + payload.size),
                  .substream = substream_,
                  .number = mine,
                  .key = head.key,
                  .layer = layer,
                  .reason = payload.reason,
                  .updates = payload.updates};
  }

  void request_key() noexcept {
    key_.request();
    if (baseline_ == Baseline::acknowledged) base_ = 0, oldest_ = next_;
  }

  /// Report that the last packet was never sent. Its number is free again. At most once per packet.
  void forget_last() noexcept {
    if (!std::exchange(can_forget_, false)) return;
    states_.pop();
    --next_;
    oldest_ = oldest_ < next_ ? oldest_ : next_;
    if constexpr (requires { codec_.forget_last(); }) codec_.forget_last();
    const bool requested = key_.is_requested();
    key_ = before_.key;
    if (requested) key_.request();
    base_ = before_.base < oldest_ ? 0 : before_.base;
    newest_ = 0;
  }

  /// Report that the receiver holds the state after packet `number`.
  void acknowledge(std::uint64_t number) noexcept {
    if (baseline_ != Baseline::acknowledged) return;
    if (number < oldest_ || number >= next_) return;
    if constexpr (requires { codec_.acknowledge(number); }) codec_.acknowledge(number);
    if (number > base_ && states_.find(number) != nullptr) base_ = number;
  }

  /// The newest state is sent again, made anew, when no acknowledgement has named it for `ack_timeout` ticks, then for twice as long, and so
  /// on up to 64 times: another packet may never come. Nothing without Baseline::acknowledged.   in   ticks  0: never
  void set_ack_timeout(std::int64_t ticks) noexcept {
    constexpr std::int64_t kMost = 1 << 24;
    ack_timeout_ = baseline_ == Baseline::acknowledged ? std::clamp<std::int64_t>(ticks, 0, kMost) : 0;
  }

  /// A packet is required even if there is nothing new: a key packet is requested, or the newest state is to be sent again.
  bool is_owed(std::int64_t tick) const noexcept { return key_.is_requested() || is_overdue(tick); }

  const State& newest() const noexcept { return states_.newest(); }
  Codec& codec() noexcept { return codec_; }

 private:
  /// Baseline of a packet of this number; null: the initial state.
  const State* baseline_of(std::uint64_t number) const noexcept {
    return number - base_ > farthest_baseline(span_) ? nullptr : states_.find(base_);
  }

  bool is_overdue(std::int64_t tick) const noexcept {
    return ack_timeout_ > 0 && newest_ > base_ && tick - states_.newest().tick > ack_timeout_ << repeats_;
  }

  static constexpr unsigned kMostRepeats = 6;

  struct Before {
    KeyPolicy key;
    std::uint64_t base;
  };

  Codec codec_;
  BaselineRing<State> states_;
  KeyPolicy key_;
  Baseline baseline_;
  std::uint32_t span_;
  std::size_t substream_, start_;        // its number; where a packet begins behind that number
  std::vector<UntouchedBytes> buffers_;  // one per layer
  std::uint64_t next_ = 1;               // number of the next packet
  std::uint64_t base_ = 0;               // number of the baseline of the next packet
  std::uint64_t oldest_ = 0;             // lowest base_ allowed: a receiver that asked for a key holds none before
  Before before_{key_, 0};               // the last packet
  bool can_forget_ = false;
  std::uint64_t newest_ = 0;      // number of the newest state; 0: of none
  std::int64_t ack_timeout_ = 0;  // [ticks] until it is acknowledged, if it arrived; 0: not known
  unsigned repeats_ = 0;          // of it so far, at most kMostRepeats
};

}  // namespace tactus
