// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace tactus::seal {

inline constexpr std::size_t kOverhead = 29;        ///< [bytes] of a record: 13 of its head, 16 of its tag
inline constexpr std::size_t kLargestPlain = 1200;  ///< [bytes] that are sealed at a time
inline constexpr std::size_t kLargestSealed = kLargestPlain + kOverhead;

/// What keys of one handshake may be used for (RFC 9147, section 4.5.3).
struct Limits {
  std::uint64_t sealed = (std::uint64_t{1} << 48) - 1024;  ///< records sealed
  std::uint64_t dropped = std::uint64_t{1} << 36;          ///< records that were not authentic
};

/// What an end of the seal did. Nothing of it is in the traffic of the session.
struct Counters {
  std::uint64_t handshakes = 0;   ///< that came to their end
  std::uint64_t sealed = 0;       ///< records with a datagram of the session
  std::uint64_t opened = 0;       ///< the same, heard
  std::uint64_t unauthentic = 0;  ///< records dropped: forged, damaged, or of an association before
  std::uint64_t replayed = 0;     ///< records dropped that had been heard, or were too old to tell
  std::uint64_t strangers = 0;    ///< datagrams dropped that belong to no association and no handshake, or are no record
  std::uint64_t cookies = 0;      ///< answers to addresses that had not proven themselves
};

}  // namespace tactus::seal
