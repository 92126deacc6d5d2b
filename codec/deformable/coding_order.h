// SPDX-License-Identifier: Apache-2.0
/// In which order vertices are coded, and from which others each may be predicted. spec/50-deformable.md sections 4.2 and 4.3.
/// Internal to the library.
#pragma once

#include <cstdint>
#include <vector>

#include <tactus/deformable/graph.h>

namespace tactus {

/// From coarse to fine: vertices in ever finer maximal independent sets.
struct CodingOrder {
  std::vector<std::uint32_t> order;  ///< every vertex once
  std::vector<std::uint8_t> depth;   ///< by vertex: 0 finest; roots have the highest
  ListOfLists<std::uint32_t>
      near;  ///< by place in `order`: at most kParents vertices before it, the nearest first; roots have none
};

/// pre  the triangles name existing vertices, at most 2^20.   time 0.4 us per vertex, allocates
CodingOrder coding_order(const DeformableObject& object);

}  // namespace tactus
