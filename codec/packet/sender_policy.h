// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tactus {

/// The baseline of packets other than key packets.
enum class Baseline : std::uint8_t {
  previous,      ///< the state of the packet before: fewest bits; after a loss receivers wait for a key packet
  acknowledged,  ///< the newest acknowledged state, at most Scene::baseline_span packets ago: a loss interrupts nothing.
                 ///< Layered objects use `previous` in any case: each layer takes the other one from the packet before
  repaired,  ///< `previous` for rigid objects and for deformable ones of profile main without layers, `acknowledged` for the others: for a
             ///< transport that sends lost packets again, and a receiver that holds those whose baseline it lacks
};

/// What the link to the receiver and back does, as measured. It decides when Baseline::acknowledged sends a state again.
struct LinkState {
  std::int64_t ack_timeout = 0;  ///< [ticks] after which a packet that arrived is acknowledged: round trip, jitter, time between
                                 ///< acknowledgements. 0: not known, nothing is sent again
  double loss = 0;               ///< fraction of packets, 0 to 1
  bool copies =
      false;  ///< what is lost also comes again as it was, and in time: nothing is made anew before the acknowledgement is due
  bool waits = false;  ///< packets wait for their turn: rigid objects join one sooner. Also with Baseline::repaired
};

struct SenderPolicy {
  /// [s] After this long the next packet builds on the initial state (a tick to seek to). 0: never.
  double key_interval = 5.0;
  Baseline baseline = Baseline::previous;
  /// [s] After this long without a packet of the rigid objects one of them is sent again, and at once at the beginning: a receiver that
  /// shows the past then knows the time. 0: never. Where states are acknowledged it does what the heartbeat of every object would.
  double silence = 0;
};

}  // namespace tactus
