// SPDX-License-Identifier: Apache-2.0
/// Packets that do not fit into one datagram, put together again. spec/70-session.md section 5. Internal to the library.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/session/datagram.h>

namespace tactus {

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

}  // namespace tactus
