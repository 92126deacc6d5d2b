// SPDX-License-Identifier: Apache-2.0
/// Packets and declarations in parts that fit a datagram, and what goes again. Integers. Internal to the library.
#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/base/untouched.h>
#include <tactus/packet/packet.h>
#include <tactus/session/congestion.h>
#include <tactus/session/datagram.h>

namespace tactus {

// ==== fragments ====
// Packets that do not fit into one datagram, put together again. spec/70-session.md section 5.

inline constexpr std::size_t kFragmentSize = 1150;  ///< [bytes] of all but the last
inline constexpr std::size_t kMostFragments = 1024;

class Fragments {
 public:
  static constexpr std::size_t kMost = 32;  ///< packets at a time; a newer one takes the place of the oldest

  /// Nothing is allocated if no packet is larger than a fragment.   in  largest  packet [bytes]
  explicit Fragments(std::size_t largest);

  /// A packet that is complete. Valid until the next call.
  struct Complete {
    std::uint64_t number = 0, substream = 0;
    std::span<const std::uint8_t> packet;
  };
  struct Taken {
    bool kept = false;                 ///< to be acknowledged: it is held for its packet, or that is decoded
    std::optional<Complete> complete;  ///< the packet, once, when this was the last fragment that it lacked
  };
  /// in   datagram  its number
  /// err  invalid R-SES-7: index, count or length; the packet's number is below 1, or it is larger than any of the scene
  Result<Taken> take(std::uint64_t datagram, const FragmentPart& fragment) noexcept;
  void decoded(const Complete& packet) noexcept;  ///< pre  take() has just returned it
  /// There was no room for it: the fragment that completed it is as if it had never come.   pre  take() has just returned it for this fragment
  void refused(const Complete& packet, std::size_t index) noexcept;

 private:
  struct Packet {
    std::uint64_t number = 0, substream = 0;  // number 0: empty
    std::size_t count = 0, have = 0, size = 0;
    bool is_decoded = false;
    UntouchedBytes bytes;
    std::bitset<kMostFragments> has;  // by fragment
  };
  Packet* find(std::uint64_t number, std::uint64_t substream) noexcept;
  Packet* slot_for(std::uint64_t number, const FragmentPart& fragment) noexcept;

  std::size_t largest_;
  std::vector<Packet> packets_;
};

// ==== sent fragments ====
// Packets that went in fragments: one has arrived when all of its fragments have. spec/70-session.md section 4.

class SentFragments {
 public:
  static constexpr std::size_t kMost = 32;  ///< packets in flight; the oldest is forgotten, and never counts as arrived

  /// time O(1), no allocation.   pre  2 <= count <= kMostFragments
  void send(const Packet& packet, std::size_t count) noexcept {
    Sent& sent = sent_[next_++ % kMost];
    sent = {.number = packet.number, .substream = packet.substream, .left = count, .arrived = {}};
  }

  /// A fragment has arrived, perhaps again.
  /// out  true, once: all of the packet have
  bool arrived(std::uint64_t number, std::size_t substream, std::size_t index) noexcept {
    for (Sent& sent : sent_) {
      if (sent.number != number || sent.substream != substream || sent.arrived[index]) continue;
      sent.arrived[index] = true;
      return --sent.left == 0;
    }
    return false;
  }

 private:
  struct Sent {
    std::uint64_t number = 0;  // 0: none
    std::size_t substream = 0, left = 0;
    std::bitset<kMostFragments> arrived;
  };
  std::array<Sent, kMost> sent_{};
  std::size_t next_ = 0;
};

// ==== pieces ====
// A scene declaration in pieces. spec/70-session.md section 6.

inline constexpr std::uint64_t kPieceSize = 1024;  ///< [bytes] of all but the last

constexpr std::uint64_t piece_count(std::uint64_t size) noexcept { return size / kPieceSize + (size % kPieceSize > 0 ? 1 : 0); }

inline constexpr std::uint64_t kLargestPieceWindow = 1024;
/// Pieces from the first that is missing on that a client takes once so many have come.
constexpr std::uint64_t piece_window(std::uint64_t received) noexcept {
  return received < 60 ? 64 + 16 * received : kLargestPieceWindow;
}

class PieceSender {
 public:
  /// in   least_gap  [us] from piece to piece at the rate that the user states
  explicit PieceSender(std::shared_ptr<const std::vector<std::uint8_t>> declaration, std::uint64_t least_gap = 0) noexcept
      : pacer(least_gap), bytes_(std::move(declaration)) {}

  LinePacer pacer;

  bool is_done() const noexcept { return front_ == piece_count(bytes_->size()); }
  /// The next piece to send: one that is lost, or a new one. Nothing: as many are in flight as may be.
  std::optional<std::uint64_t> next() const noexcept;
  std::span<const std::uint8_t> bytes(std::uint64_t index) const noexcept;
  void sent(std::uint64_t index) noexcept;     ///< pre  next() has returned it
  void arrived(std::uint64_t index) noexcept;  ///< perhaps again, or after it was lost
  void lost(std::uint64_t index) noexcept;     ///< its newest datagram is
  std::uint64_t in_flight() const noexcept { return count_; }

 private:
  class Set {  // of indices from the front on
   public:
    bool has(std::uint64_t index) const noexcept { return (word(index) >> index % 64 & 1u) != 0; }
    void set(std::uint64_t index) noexcept { words_[index / 64 % words_.size()] |= std::uint64_t{1} << index % 64; }
    void clear(std::uint64_t index) noexcept { words_[index / 64 % words_.size()] &= ~(std::uint64_t{1} << index % 64); }
    std::uint64_t word(std::uint64_t index) const noexcept { return words_[index / 64 % words_.size()]; }  ///< it is in

   private:
    std::array<std::uint64_t, kLargestPieceWindow / 64> words_{};
  };
  std::shared_ptr<const std::vector<std::uint8_t>> bytes_;
  std::uint64_t front_ = 0, next_ = 0;      // first that has not arrived, first that was never sent
  std::uint64_t count_ = 0, received_ = 0;  // in flight; that have arrived
  Set arrived_, in_flight_;
};

class PieceReceiver {
 public:
  /// in   size, hash  of the declaration; nothing is allocated for it before its pieces come
  PieceReceiver(std::uint64_t size, std::uint64_t hash) noexcept : size_(size), hash_(hash) {}

  /// err  invalid R-SES-8: not a piece of this declaration, beyond the window, or of another length; limit_exceeded R-API-11 memory
  Result<void> take(std::uint64_t index, std::span<const std::uint8_t> bytes);
  bool is_complete() const noexcept { return front_ == piece_count(size_); }
  /// The declaration.   pre  is_complete()   err  checksum R-SES-10
  Result<std::span<const std::uint8_t>> declaration() const noexcept;
  std::uint64_t received() const noexcept { return count() * kPieceSize; }  ///< [bytes], about
  std::uint64_t size() const noexcept { return size_; }

 private:
  std::uint64_t count() const noexcept { return front_ + above_.size(); }

  std::uint64_t size_, hash_;
  std::uint64_t front_ = 0;
  std::vector<std::uint8_t> bytes_;                           // of the pieces below the front
  std::map<std::uint64_t, std::vector<std::uint8_t>> above_;  // it takes no more memory than came
};

// ==== resends ====
// Packets that went out, whole or in fragments, so that what is lost goes again as it was. spec/70-session.md section 4.2.

class Resends {
 public:
  static constexpr std::uint16_t kNone = 0xffff;  ///< no slot

  /// What one datagram brought of a packet.
  struct Portion {
    std::size_t index = 0, count = 1;  ///< of fragments; count 1: the whole packet
    std::span<const std::uint8_t> bytes;
  };
  struct Kept {
    std::array<std::uint64_t, 4> datagrams;       // that brought it, the newest first; 0: none
    std::uint64_t number;                         // of the packet
    std::uint64_t time, due;                      // [us] when it first went; when a copy may go
    std::uint64_t begin;                          // of its bytes
    std::uint16_t substream, index, count, size;  // index, count: as in Portion
    std::uint8_t copies;                          // that are to go
    bool is_chained;                              // the packets of its substream after it build on it
    bool is_settled;                              // it has arrived, or nobody needs it any more
  };
  /// [us] from the first sending of a packet to the arrival of its copy, at most.
  struct Latest {
    std::uint64_t chained = 0;           ///< of those that build on each other
    std::uint64_t rigid = 0, shape = 0;  ///< of others
    std::uint64_t one_way = 0;           ///< from here to the other end
  };

  /// Allocates for kKept datagrams of 64 KiB in all and one packet more.   in  largest  packet [bytes]
  explicit Resends(std::size_t largest, std::size_t substreams = 1);

  /// in   is_chained  the packets of its substream build on each other
  /// out  its slot, for arrived() and lost() of the datagram
  std::uint16_t keep(std::uint64_t datagram, const Packet& packet, const Portion& portion, std::uint64_t now,
                     bool is_chained) noexcept;
  /// It is held yet, or has arrived: the datagram that brought what had this slot need not have.
  bool keeps(std::uint16_t slot, std::uint64_t datagram) const noexcept;
  /// The datagram that brought what has this slot.
  void arrived(std::uint16_t slot, std::uint64_t datagram) noexcept;
  /// in   copies  that should go, 10 ms apart; none while a newer datagram with it is in flight
  void lost(std::uint16_t slot, std::uint64_t datagram, std::uint64_t now, unsigned copies) noexcept;
  /// The copy that goes next.   time O(packets that wait)
  const Kept* next(std::uint64_t now, const Latest& latest) noexcept;
  std::span<const std::uint8_t> bytes(const Kept& kept) const noexcept {
    return std::span(bytes_).subspan(static_cast<std::size_t>(kept.begin % bytes_.size()), kept.size);
  }
  /// It went in this datagram, which takes over from the one before.   pre  next() has just returned it   out  its slot
  std::uint16_t sent(const Kept& copy, std::uint64_t datagram, std::uint64_t now) noexcept;
  std::optional<std::uint64_t> due() const noexcept;  ///< [us] when the next copy may go; nothing: none is to go

  /// A chained packet of this substream will not arrive, or so late that it is no use: all after it wait. Each once.
  std::optional<std::size_t> poll_broken() noexcept;
  void break_chain(std::size_t substream) noexcept;
  /// This packet is lost, and held no more. Before the key packet that the chain began with it does not matter.
  void miss(std::size_t substream, std::uint64_t number) noexcept {
    if (number >= begun_[substream]) break_chain(substream);
  }
  /// The chain begins anew: packets of this substream below this number need not arrive any more.   time O(kept)
  void settle_chain(std::size_t substream, std::uint64_t number) noexcept;

 private:
  static constexpr std::size_t kKept = 1024, kBytes = 65536;
  void pop() noexcept;
  void settle(Kept& kept) noexcept;
  void unqueue(std::uint16_t slot) noexcept;

  std::vector<Kept, Untouched<Kept>> kept_;  // a ring; only slots that were kept are looked at
  UntouchedBytes bytes_;
  std::vector<std::uint16_t> waiting_;  // slots of what has copies to go
  std::size_t first_ = 0, count_ = 0;
  std::uint64_t end_ = 0;             // of the bytes
  std::vector<std::uint8_t> broken_;  // by substream
  std::vector<std::uint64_t> begun_;  // the same: number of the newest key packet
  std::size_t count_broken_ = 0;
};

// ==== held packets ====
// Chained packets whose baseline is not there yet. spec/70-session.md section 4.4.

class HeldPackets {
 public:
  static constexpr std::size_t kMost = 1024, kBytes = 65536;  ///< packets; [bytes], or one packet if that is larger
  static constexpr std::uint64_t kLongest = 2'000'000;        ///< [us]

  struct Held {
    std::uint64_t number = 0;
    std::uint64_t at = 0;  ///< [us] when it came
    std::size_t begin = 0, size = 0;
    std::size_t substream = 0;
  };

  explicit HeldPackets(std::size_t largest) : bytes_(std::max(kBytes, largest)) {
    held_.reserve(kMost);
    order_.reserve(kMost);
  }

  /// False: there is no room.   time O(held)
  bool hold(std::uint64_t number, std::size_t substream, std::span<const std::uint8_t> packet, std::uint64_t now) noexcept;
  bool empty() const noexcept { return held_.empty(); }
  std::size_t size() const noexcept { return held_.size(); }
  /// What is held, by number and substream.
  const Held& operator[](std::size_t i) const noexcept { return held_[i]; }
  std::span<const std::uint8_t> bytes(const Held& held) const noexcept {
    return std::span(bytes_).subspan(held.begin, held.size);
  }
  /// [us] when the first of them came, of those that came not longer than kLongest ago; nothing: none is held.   time O(held)
  std::optional<std::uint64_t> waits_since(std::uint64_t now) const noexcept;
  /// Forget those for which `done(held)` is true.
  template <class Done>
  void remove_if(Done&& done) noexcept {
    std::erase_if(held_, done);
    if (held_.empty()) end_ = 0;
  }

 private:
  void compact() noexcept;

  std::vector<Held> held_;
  UntouchedBytes bytes_;
  std::vector<std::uint16_t> order_;
  std::size_t end_ = 0;
};

}  // namespace tactus
