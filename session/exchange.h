// SPDX-License-Identifier: Apache-2.0
/// One end of an epoch: numbered datagrams out and in, what they acknowledge, and the packets in them. spec/70-session.md sections 4, 5
/// and 7. Internal to the library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/receiver.h>
#include <tactus/rigid/device_path.h>
#include <tactus/sender.h>
#include <tactus/session/datagram.h>
#include <tactus/session/fragments.h>
#include <tactus/session/numbers.h>
#include <tactus/session/session_options.h>

namespace tactus {

inline constexpr std::uint64_t kHashEvery =
    64;  ///< packets with a number that this divides: clients report the hash of the state
/// [us] of acknowledgements in these directions; of a device whose path both ends know, while they report nothing that is missing
inline constexpr std::uint64_t kUpAckDelay = 10'000, kDownAckDelay = 25'000, kDrivenAckDelay = 140'000;

/// pre  `now` [us] never decreases.   Only receive_with() allocates.
class Exchange {
 public:
  /// in   direction  of what it sends
  Exchange(Direction direction, std::uint64_t epoch, std::uint64_t now) noexcept
      : direction_(direction), epoch_(epoch), writer_(direction), heard_at_(now), sent_at_(now) {}

  std::uint64_t epoch() const noexcept { return epoch_; }

  std::optional<Sender> sender;       ///< of the packets that go; none: no packets go. Set by send_with()
  std::optional<Receiver> receiver;   ///< of those that come; none: all are refused
  std::optional<PieceSender> pieces;  ///< of the declaration, until all have arrived
  std::shared_ptr<DevicePath> path;   ///< of the device whose packets go up; none: it drives nothing

  /// in   repairs  packets build on the one before, where they may: what is lost goes again until it arrives, or they begin anew
  void send_with(Sender coder, bool repairs = false);  ///< allocates
  void receive_with(Receiver decoder);                 ///< allocates, to hold packets and to put fragments together

  // In

  /// What the packets of a datagram brought.
  struct Heard {
    std::uint64_t number = 0;          ///< of the datagram
    std::optional<std::int64_t> tick;  ///< newest of the packets that were decoded
    /// Newest and oldest of those that were no copies; the tick of a copy of rigid objects or in a chain says nothing about the delay.
    std::optional<std::int64_t> newest, oldest;
    bool has_copy = false;  ///< one was a copy
    /// Of the packets that were held until now, those with the shortest and the longest delay.
    struct Arrival {
      std::int64_t tick = 0;
      std::uint64_t at = 0;  ///< [us]
    };
    std::optional<std::array<Arrival, 2>> held;
    std::optional<HashPart> hash;            ///< to be reported to the sender
    std::optional<std::int64_t> round_trip;  ///< [us] that its acknowledgement measured
  };
  /// in   take  Result<void>(const Part&, const Heard&), for the parts that are not acknowledgements, fragments and packets, in order
  /// err  state R-SES-4 an old number; invalid R-SES-6, R-SES-7; what `take` returns. Parts before it have taken effect. A packet that
  ///      is refused is counted, not an error: the datagram is not acknowledged
  template <class Take>
  Result<Heard> handle(std::uint64_t now, const Numbered& datagram, Take&& take) noexcept {
    TACTUS_TRY(const std::uint64_t number, receive(now, datagram));
    Reading reading{
        {.number = number, .tick = {}, .newest = {}, .oldest = {}, .has_copy = false, .held = {}, .hash = {}, .round_trip = {}},
        now};
    PartReader parts = datagram.parts(direction_ == Direction::up ? Direction::down : Direction::up);
    for (;;) {
      TACTUS_TRY(const std::optional<Part> part, parts.next());
      if (!part) break;
      TACTUS_TRY(const bool taken, handle(*part, reading));
      if (!taken) TACTUS_CHECK(take(*part, reading.heard));
    }
    finish(reading);
    return reading.heard;
  }

  // Out

  /// Code the packets of a tick; they wait for poll() until the next submit(). None, while too little is acknowledged.
  /// err  of Sender::encode
  Result<std::span<const Packet>> submit(std::uint64_t now, std::int64_t tick, const Truth& truth) noexcept;

  /// The next datagram, valid until the next call; nothing: none is due.
  /// in   wanted  one should go even if there are neither packets nor acknowledgements due
  ///      extras  bool(DatagramWriter&, number), adds parts of types 2 to 6; true: the other end must acknowledge them
  template <class Extras>
  std::optional<std::span<const std::uint8_t>> poll(std::uint64_t now, bool wanted, Extras&& extras) noexcept {
    watch_tail(now);
    if (!wanted && !has_packets() && !is_acknowledgement_due(now) && !next_copy(now)) return std::nullopt;
    const auto number = begin(now, wanted);
    if (!number) return std::nullopt;
    const bool is_eliciting = extras(writer_, *number);
    const auto datagram = end(now, is_eliciting);
    return datagram.empty() ? std::nullopt : std::optional(datagram);
  }

  /// When poll() has something without anything else happening; nothing: never.
  std::optional<std::uint64_t> due() const noexcept;
  bool has_packets() const noexcept { return next_packet_ < packets_.size(); }
  /// While nothing of what was sent is acknowledged for long, an end sends little.
  bool may_send(std::uint64_t now) const noexcept { return next_send(now) <= now; }
  std::uint64_t next_send(std::uint64_t wanted) const noexcept;  ///< [us] when what should go at `wanted` may go

  std::uint64_t heard_at() const noexcept { return heard_at_; }  ///< [us] when the newest datagram came
  std::uint64_t sent_at() const noexcept { return sent_at_; }    ///< [us] when the last one went
  /// [us] since when an answer is missing; nothing: none is
  std::optional<std::uint64_t> unanswered() const noexcept {
    return eliciting_ > sent_.highest_acknowledged() ? std::optional(progress_at_) : std::nullopt;
  }
  std::uint64_t eliciting_at() const noexcept {
    return eliciting_at_;
  }                                                     ///< [us] when the last one went that must be acknowledged
  void hold_tick() noexcept { ++traffic_.ticks_held; }  ///< instead of submit(): nothing may be sent
  void set_waits(bool waits) noexcept;                  ///< packets wait for their turn
  const SentNumbers& sent() const noexcept { return sent_; }
  /// Add the next piece to the datagram of this number.   pre  there is one
  bool add_piece(DatagramWriter& writer, std::uint64_t number, std::uint64_t now) noexcept;
  void expire_pieces(std::uint64_t now) noexcept;            ///< what should be acknowledged by now goes again
  std::optional<std::uint64_t> pieces_due() const noexcept;  ///< [us] when that is; nothing: none is in flight
  /// [us] since when the first packet that is held waits; nothing: none is held, or for longer than it has a use.
  std::optional<std::uint64_t> waits_since(std::uint64_t now) const noexcept {
    return held_ ? held_->waits_since(now) : std::nullopt;
  }
  /// The client has asked for key packets. It gets them, but not more often than one can be answered.
  void want_key(std::uint64_t now) noexcept;
  void set_playout(std::uint64_t delay) noexcept { playout_ = delay; }  ///< [us] of the client, as it has reported
  /// On what packets that come build: numbers without one of rigid objects are then not missing.
  void expect(bool repaired) noexcept { repaired_ = repaired; }
  bool is_repaired() const noexcept { return repaired_; }
  std::uint64_t ack_timeout() const noexcept;  ///< [us] after which an acknowledgement should have come
  const Traffic& traffic() const noexcept { return traffic_; }

 private:
  struct Reading {
    Heard heard;
    std::uint64_t now = 0;
    AckTiming ack_timing = AckTiming::never;
    bool complete = true;  // all packets in it are decoded, or its fragment is kept
  };
  struct PacketName {
    std::uint16_t substream = 0;
    std::uint16_t back = 0;  // the packet's number is so far below the datagram's; what is kept for copies never is older
  };
  struct FragmentName {
    std::uint64_t number = 0;  // of the packet; 0: no fragment
    std::uint16_t index = 0;
  };
  struct Slot {
    std::uint64_t number = 0;
    std::array<PacketName, 8> packets{};
    std::array<std::uint16_t, 8> kept{};  // where to find them for copies
    FragmentName fragment{};              // of the only packet
    std::uint8_t count = 0;
    bool layered = false;
    std::uint32_t piece = 0;  // its index + 1; 0: none
  };

  Result<std::uint64_t> receive(std::uint64_t now, const Numbered& datagram) noexcept;
  Result<bool> handle(const Part& part, Reading& reading) noexcept;
  Result<void> acknowledged(const Acknowledgement& ack, Reading& reading) noexcept;
  void update_pacer(const Acknowledgement& ack, std::uint64_t now) noexcept;
  Result<void> take(const FragmentPart& fragment, Reading& reading) noexcept;
  bool decode(std::uint64_t number, std::span<const std::uint8_t> packet, Reading& reading) noexcept;
  bool hold(std::uint64_t number, std::span<const std::uint8_t> packet, const Error& error, std::uint64_t now) noexcept;
  void take_held(std::size_t substream, Reading& reading) noexcept;
  bool took(const DecodedPacket& decoded, std::size_t size, Reading& reading) noexcept;
  void accept(std::uint64_t number, const Reading& reading) noexcept;
  void finish(const Reading& reading) noexcept;
  void report_link() noexcept;
  ReceivedNumbers::AckDelay own_ack_delay() const noexcept;

  bool is_acknowledgement_due(std::uint64_t now) const noexcept { return received_.due() && *received_.due() <= now; }
  std::optional<std::uint64_t> begin(std::uint64_t now, bool wanted) noexcept;
  void give_up() noexcept;
  void skip_number(std::uint64_t now) noexcept;
  bool misses_layers(std::uint64_t now) const noexcept;
  bool add_packets(std::uint64_t number, std::uint64_t now) noexcept;
  bool add_whole(const Packet& packet, std::uint64_t number, std::uint64_t now) noexcept;
  bool add_fragment(const Packet& packet, std::uint64_t number, std::uint64_t now) noexcept;
  std::uint16_t keep(std::uint64_t number, const Packet& packet, const Resends::Portion& portion, std::uint64_t now) noexcept;
  bool shapes_come_in_time() const noexcept;
  bool chains(std::uint64_t substream) const noexcept;
  bool waits_for(std::uint64_t substream) const noexcept;
  bool copies_rigid() const noexcept { return repairs_ || fixed_playout_; }
  bool rigid_comes_in_time() const noexcept;
  bool may_copy(std::uint64_t substream) const noexcept;
  Resends::Latest latest() const noexcept;
  unsigned copies_of(std::uint64_t substream) const noexcept;
  void lose(std::uint64_t number, std::uint64_t now) noexcept;
  std::optional<std::uint64_t> tail_due() const noexcept;
  void watch_tail(std::uint64_t now) noexcept;
  void begin_chains(std::uint64_t now) noexcept;
  bool is_cut_off(std::uint64_t now) const noexcept;
  const Resends::Kept* next_copy(std::uint64_t now) noexcept;
  bool add_copies(std::uint64_t number, std::uint64_t now) noexcept;
  bool add_copy(const Resends::Kept& copy, std::uint64_t number) noexcept;
  std::span<const std::uint8_t> end(std::uint64_t now, bool is_eliciting) noexcept;

  Direction direction_;
  unsigned timeouts_ = 0;  // of pieces, since the last that arrived
  std::uint64_t epoch_;
  DatagramWriter writer_;
  ReceivedNumbers received_;
  SentNumbers sent_;
  Fragments fragments_{0};
  std::array<Slot, SentNumbers::kRemembered> slots_{};
  SentFragments sent_fragments_;
  std::optional<Resends> resends_;     // none: no packet goes twice
  std::optional<HeldPackets> held_;    // none: what lacks its baseline is refused
  std::vector<std::uint64_t> newest_;  // by substream, at a receiver: number of the newest packet that was decoded
  std::vector<std::uint64_t> heard_;   // the same, or that is held
  std::uint64_t newest_packet_ = 0;    // highest number that a packet was given
  bool repairs_ = false, repaired_ = true, waits_ = false;
  bool fixed_playout_ = false;       // by its user: known before the first packet
  std::uint64_t playout_ = 0;        // [us] of the client
  std::uint64_t tail_at_ = 0;        // [us] when the newest ack-eliciting datagram was last taken for lost
  bool wants_chains_ = false;        // chains must begin anew
  std::uint64_t chains_at_ = 0;      // [us] when they did, all of them
  std::span<const Packet> packets_;  // of the last submit()
  std::size_t next_packet_ = 0, next_fragment_ = 0;
  std::uint64_t heard_at_, sent_at_;
  std::uint64_t eliciting_at_ = 0;   // [us] when it went
  std::uint64_t eliciting_ = 0;      // highest ack-eliciting number
  std::uint64_t progress_at_ = 0;    // [us] when one was acknowledged, or the first ack-eliciting one went
  std::uint64_t layered_ = 0;        // highest number that brings a layer of a mesh
  bool wants_key_ = false;           // a layer is lost
  std::uint64_t key_wanted_at_ = 0;  // [us]
  Traffic traffic_;
};

}  // namespace tactus
