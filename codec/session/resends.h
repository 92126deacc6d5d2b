// SPDX-License-Identifier: Apache-2.0
/// Packets of deformable objects that went out, whole or in fragments, so that what is lost goes again while their tick may still be shown.
/// spec/70-session.md section 4.2. Internal to the library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <tactus/packet/packet.h>

namespace tactus {

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
