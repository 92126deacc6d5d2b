// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tactus {

/// What an end of a session sent and heard. Sizes are those of datagrams with their check, without seal and headers of the network.
struct Traffic {
  std::uint64_t datagrams_sent = 0, bytes_sent = 0;
  std::uint64_t packets_sent = 0, payload_sent = 0;  ///< packets, and their bytes
  std::uint64_t datagrams_heard = 0, bytes_heard = 0;
  std::uint64_t packets_heard = 0, payload_heard = 0;
  std::uint64_t packets_refused = 0;  ///< could not be decoded
  std::uint64_t packets_held = 0;     ///< too large, or the program did not take their datagrams before the next tick
  std::uint64_t lost = 0;             ///< of the datagrams sent, as far as is known
  std::uint64_t ticks_held = 0;    ///< in which nothing was coded, as the rate or the missing acknowledgements did not permit it
  std::uint64_t wrong_states = 0;  ///< hashes that the other end told and that are not those of the sender
};

}  // namespace tactus
