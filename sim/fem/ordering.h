// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace tactus {

/// Who is connected with whom: neighbours of node i are neighbours[begin[i] .. begin[i+1]), without i itself.
struct Graph {
  std::vector<int> begin, neighbours;
  int size() const noexcept { return static_cast<int>(begin.size()) - 1; }
};

/// An order of elimination that keeps the fill of a Cholesky factor low: nested dissection by breadth-first levels (George and Liu
/// 1981, chapter 8). The nodes of a middle level part the rest in two; they come last, and each part is parted again.
/// ret  order[k] is the node eliminated as number k.   time O(n log n); allocates
std::vector<int> nested_dissection(const Graph& graph);

}  // namespace tactus
