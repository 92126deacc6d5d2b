// SPDX-License-Identifier: Apache-2.0
/// Packets that went in fragments: one has arrived when all of its fragments have. spec/70-session.md section 4. Internal to the library.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>

#include <tactus/packet/packet.h>
#include <tactus/session/fragments.h>

namespace tactus {

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

}  // namespace tactus
