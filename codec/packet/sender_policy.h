// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tactus {

/// Which state a packet builds on, if not the initial one.
enum class Baseline : std::uint8_t {
  previous,      ///< that of the packet before: the fewest bits; after a loss receivers wait for a key packet
  acknowledged,  ///< the newest that the receiver has acknowledged, at most Scene::baseline_span packets ago: no loss stops it.
                 ///< A layered object builds on its packet before all the same: each layer leaves the other as it is there
};

struct SenderPolicy {
  double key_interval =
      5.0;  ///< [s] after this long the next packet builds on the initial state (a place to seek to); 0: never, but
            ///< after 8 s of silence, when receivers may soon have forgotten what there was
  std::uint16_t first_sequence = 1;  ///< a sender that begins anew towards the same receivers takes another number, at random
  Baseline baseline = Baseline::previous;
};

}  // namespace tactus
