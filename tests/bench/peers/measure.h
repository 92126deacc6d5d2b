// SPDX-License-Identifier: Apache-2.0
/// What one scheme makes of one animation.
#pragma once

#include <optional>

#include "tests/bench/peers/link.h"

namespace tactus::peers {

struct Measurement {
  double bytes = 0;                     ///< per frame, mean over all but the first
  double bits_per_vertex = 0;           ///< the same, per vertex
  double encode_us = 0, decode_us = 0;  ///< CPU time per frame, median
  double kg_percent = 0;  ///< root mean square error over that of the vertices about the mean of each frame (Karni and Gotsman)
  double error = 0;       ///< largest distance of a shown vertex from the position before rounding, grid units
  std::optional<bool>
      survives;  ///< after one packet was lost the next one decodes to the same; none: no two in a row that change something
};

/// None: the scheme cannot carry this mesh.
std::optional<Measurement> measure(const Animation& animation, const Scheme& scheme);

}  // namespace tactus::peers
