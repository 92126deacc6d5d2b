// SPDX-License-Identifier: Apache-2.0
#include "sim/fem/ordering.h"

#include <algorithm>
#include <cstddef>

namespace tactus {
namespace {

constexpr std::size_t kLeaf = 8;  ///< parts this small are not parted again

class Dissection {
 public:
  explicit Dissection(const Graph& graph)
      : graph_(graph), part_(static_cast<std::size_t>(graph.size()), 0), level_(part_.size(), -1) {
    order_.reserve(part_.size());
  }

  std::vector<int> run() {
    std::vector<int> all(part_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
    // Last first: a part's separator is placed, then the two parts before it; reversed at the end.
    std::vector<std::vector<int>> stack{std::move(all)};
    while (!stack.empty()) {
      const std::vector<int> nodes = std::move(stack.back());
      stack.pop_back();
      split(nodes, stack);
    }
    std::reverse(order_.begin(), order_.end());
    return std::move(order_);
  }

 private:
  int& part(int node) { return part_[static_cast<std::size_t>(node)]; }
  int& level(int node) { return level_[static_cast<std::size_t>(node)]; }

  /// Number the nodes of `start`'s part by distance from it; `queue` holds those reached, nearest first.
  void breadth_first(int start) {
    queue_.assign(1, start);
    level(start) = 0;
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      const int node = queue_[i];
      for (int k = graph_.begin[static_cast<std::size_t>(node)]; k < graph_.begin[static_cast<std::size_t>(node) + 1]; ++k) {
        const int other = graph_.neighbours[static_cast<std::size_t>(k)];
        if (part(other) != part(node) || level(other) >= 0) continue;
        level(other) = level(node) + 1;
        queue_.push_back(other);
      }
    }
  }
  void forget_levels() {
    for (const int node : queue_) level(node) = -1;
  }

  void split(const std::vector<int>& nodes, std::vector<std::vector<int>>& stack) {
    const int id = ++parts_;
    for (const int node : nodes) part(node) = id;
    int start = nodes.front();
    for (int deepest = -1;;) {  // towards a node at the rim: farther and farther away
      breadth_first(start);
      const int far = queue_.back(), depth = level(far);
      if (depth <= deepest) break;
      deepest = depth;
      start = far;
      forget_levels();
    }
    if (queue_.size() < nodes.size()) return split_components(nodes, stack);
    const int depth = level(queue_.back());
    if (nodes.size() <= kLeaf || depth < 2) {
      forget_levels();
      order_.insert(order_.end(), nodes.rbegin(), nodes.rend());
      return;
    }
    const int middle = best_level(depth);
    std::vector<int> near, far;
    for (const int node : queue_) {
      if (level(node) > middle) far.push_back(node);
      else if (level(node) < middle || !touches(node, middle + 1)) near.push_back(node);
      else order_.push_back(node);
    }
    forget_levels();
    for (std::vector<int>* half : {&near, &far})
      if (!half->empty()) stack.push_back(std::move(*half));
  }

  void split_components(const std::vector<int>& nodes, std::vector<std::vector<int>>& stack) {
    stack.push_back(queue_);
    std::vector<int> rest;
    for (const int node : nodes)
      if (level(node) < 0) rest.push_back(node);
    forget_levels();
    stack.push_back(std::move(rest));
  }

  /// The smallest level that leaves at least three tenths of the nodes on either side, else the one in the middle.
  int best_level(int depth) {
    std::vector<std::size_t> count(static_cast<std::size_t>(depth) + 1, 0);
    for (const int node : queue_) ++count[static_cast<std::size_t>(level(node))];
    const auto total = static_cast<double>(queue_.size());
    int best = std::clamp(level(queue_[queue_.size() / 2]), 1, depth - 1);
    double before = 0;
    for (int i = 0; i < depth; ++i) {
      const auto here = static_cast<double>(count[static_cast<std::size_t>(i)]);
      const bool balanced = before >= 0.3 * total && total - before - here >= 0.3 * total;
      if (balanced && count[static_cast<std::size_t>(i)] < count[static_cast<std::size_t>(best)]) best = i;
      before += here;
    }
    return best;
  }

  bool touches(int node, int wanted) {
    for (int k = graph_.begin[static_cast<std::size_t>(node)]; k < graph_.begin[static_cast<std::size_t>(node) + 1]; ++k) {
      const int other = graph_.neighbours[static_cast<std::size_t>(k)];
      if (part(other) == part(node) && level(other) == wanted) return true;
    }
    return false;
  }

  const Graph& graph_;
  std::vector<int> part_, level_, queue_, order_;
  int parts_ = 0;
};

}  // namespace

std::vector<int> nested_dissection(const Graph& graph) {
  return graph.size() == 0 ? std::vector<int>{} : Dissection(graph).run();
}

}  // namespace tactus
