// SPDX-License-Identifier: Apache-2.0
/// Packets and declarations in parts that fit a datagram, and what goes again. Integers. Internal to the library.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/packet/packet.h>
#include <tactus/session/datagram.h>

namespace tactus {

// ==== fragments ====
// Packets that do not fit into one datagram, put together again. spec/70-session.md section 5.

inline constexpr std::size_t kFragmentSize = 1150;  ///< [bytes] of all but the last
inline constexpr std::size_t kMostFragments = 1024;

class Fragments {
 public:
  static constexpr std::size_t kMost = 4;  ///< packets at a time; a newer one takes the place of the oldest

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

 private:
  struct Packet {
    std::uint64_t number = 0, substream = 0;  // number 0: empty
    std::size_t count = 0, have = 0, size = 0;
    bool is_decoded = false;
    std::vector<std::uint8_t> bytes;
    std::bitset<kMostFragments> has;  // by fragment
  };
  Packet* find(std::uint64_t number, std::uint64_t substream) noexcept;
  Packet* place_for(std::uint64_t number, const FragmentPart& fragment) noexcept;

  std::size_t largest_;
  std::vector<Packet> packets_;
};

// ==== sent fragments ====
// Packets that went in fragments: one has arrived when all of its fragments have. spec/70-session.md section 4.

class SentFragments {
 public:
  static constexpr std::size_t kMost = 32;  ///< packets on their way; the oldest is forgotten, and never counts as arrived

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
inline constexpr std::uint64_t kPieceWindow = 64;  ///< pieces that may be on their way

constexpr std::uint64_t piece_count(std::uint64_t size) noexcept { return size / kPieceSize + (size % kPieceSize > 0 ? 1 : 0); }

/// Which of the pieces are there: all below a front, and some of the window above it.
class PieceSet {
 public:
  std::uint64_t front() const noexcept { return front_; }  ///< lowest that is missing
  bool has(std::uint64_t index) const noexcept { return index < front_ || (index < front_ + kPieceWindow && bit(index) != 0); }
  void add(std::uint64_t index) noexcept {  ///< pre  below front() + kPieceWindow
    if (index < front_) return;
    window_ |= std::uint64_t{1} << (index - front_);
    for (; (window_ & 1u) != 0; window_ >>= 1) ++front_;
  }

 private:
  std::uint64_t bit(std::uint64_t index) const noexcept { return window_ >> (index - front_) & 1u; }
  std::uint64_t front_ = 0, window_ = 0;
};

class PieceSender {
 public:
  explicit PieceSender(std::shared_ptr<const std::vector<std::uint8_t>> declaration) noexcept : bytes_(std::move(declaration)) {}

  bool is_done() const noexcept { return arrived_.front() == piece_count(bytes_->size()); }
  /// The next piece to send: new, or known or supposed to be lost.   in  patience  [us] for an acknowledgement   time O(window)
  std::optional<std::uint64_t> next(std::uint64_t now, std::uint64_t patience) const noexcept;
  /// When a piece on its way is supposed to be lost; nothing is on its way: nothing.
  std::optional<std::uint64_t> due(std::uint64_t patience) const noexcept;
  std::span<const std::uint8_t> bytes(std::uint64_t index) const noexcept;
  void sent(std::uint64_t index, std::uint64_t number, std::uint64_t now) noexcept;  ///< in a datagram of this number
  void arrived(std::uint64_t number) noexcept;
  void lost(std::uint64_t number) noexcept;
  void slow_down() noexcept;  ///< pieces wait in a queue on their way: half as many at a time

 private:
  static constexpr std::uint64_t kFirst = 8, kFewest = 4;
  struct OnItsWay {
    std::uint64_t index = 0, number = 0, time = 0;  // number 0: not on its way
  };
  std::shared_ptr<const std::vector<std::uint8_t>> bytes_;
  PieceSet arrived_;
  std::array<OnItsWay, kPieceWindow> on_its_way_{};  // by index modulo the window
  std::uint64_t most_ = kFirst;                      // from the first that has not arrived on
};

class PieceReceiver {
 public:
  /// in   size, hash  of the declaration; nothing is allocated for it before its pieces come
  PieceReceiver(std::uint64_t size, std::uint64_t hash) noexcept : size_(size), hash_(hash) {}

  /// err  invalid R-SES-8: not a piece of this declaration, beyond the window, or of another length; limit_exceeded R-API-11 memory
  Result<void> take(std::uint64_t index, std::span<const std::uint8_t> bytes);
  bool is_complete() const noexcept { return have_.front() == piece_count(size_); }
  /// The declaration.   pre  is_complete()   err  checksum R-SES-10
  Result<std::span<const std::uint8_t>> declaration() const noexcept;
  std::uint64_t received() const noexcept { return have_.front() * kPieceSize; }  ///< [bytes], about
  std::uint64_t size() const noexcept { return size_; }

 private:
  std::uint64_t size_, hash_;
  PieceSet have_;
  std::vector<std::uint8_t> bytes_;
};

// ==== resends ====
// Packets of deformable objects that went out, whole or in fragments, so that what is lost goes again while their tick may still be shown.
// spec/70-session.md section 4.2.

class Resends {
 public:
  /// What one datagram brought of a packet.
  struct Portion {
    std::size_t index = 0, count = 1;  ///< of fragments; count 1: the whole packet
    std::span<const std::uint8_t> bytes;
  };
  struct Kept {
    std::uint64_t datagram = 0, number = 0;  // that it first went with; of the packet
    std::uint64_t time = 0, due = 0;         // [us] when it first went; when a copy may go
    std::uint16_t substream = 0, sequence = 0;
    std::uint16_t index = 0, count = 1;  // as in Portion
    unsigned copies = 0;                 // that are to go
    std::vector<std::uint8_t> bytes{};
  };

  /// Allocates for kKept datagrams and those of one packet more.   in  largest  packet [bytes]
  explicit Resends(std::size_t largest);

  void keep(std::uint64_t datagram, const Packet& packet, const Portion& portion, std::uint64_t now) noexcept;
  /// in   copies  that should go, 10 ms apart
  void lost(std::uint64_t datagram, std::uint64_t now, unsigned copies) noexcept;
  /// The copy that goes next; it may be too late for it.
  /// in   way  [us] from here to the other end      time O(datagrams kept) if something is to go, else O(1)
  const Kept* next(std::uint64_t now, std::uint64_t way) noexcept;
  void sent(const Kept& copy, std::uint64_t now) noexcept;  ///< pre  next() has just returned it
  std::optional<std::uint64_t> due() const noexcept;        ///< [us] when the next copy may go; nothing: none is to go

 private:
  static constexpr std::size_t kKept = 64;
  std::vector<Kept> kept_;  // a ring
  std::size_t next_ = 0;
  unsigned waiting_ = 0;  // copies
};

}  // namespace tactus
