// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/coding_order.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>

#include <tactus/deformable/rest_distance.h>

namespace tactus {
namespace {

/// One graph of the hierarchy. Its vertices are numbered 0.. in the order of the mesh's; `vertex` gives the mesh's number.
struct Graph {
  std::vector<std::uint32_t> vertex;
  Neighbours neighbours;
};

using Flags = std::vector<std::uint8_t>;

/// Greedy maximal independent set in ascending order.
Flags independent_set(const Graph& g) {
  Flags kept(g.vertex.size(), 1);
  for (std::size_t v = 0; v < g.vertex.size(); ++v)
    if (kept[v])
      for (const std::uint32_t n : g.neighbours[v]) kept[n] = 0;
  return kept;
}

/// A vertex and how far it is, as one number: they compare by the distance, then by the vertex.
using Candidate = std::uint64_t;
constexpr unsigned kVertexBits = 20;
constexpr std::uint32_t vertex_of(Candidate c) noexcept { return static_cast<std::uint32_t>(c & ((1u << kVertexBits) - 1)); }

/// The least few of the candidates put in, ascending.
class Nearest {
 public:
  void clear() noexcept { size_ = 0; }
  void put(Candidate c) noexcept {
    if (size_ == least_.size()) {
      if (c > least_.back()) return;
      --size_;
    }
    std::size_t i = size_++;
    for (; i > 0 && least_[i - 1] > c; --i) least_[i] = least_[i - 1];
    least_[i] = c;
  }
  std::span<const Candidate> get() const noexcept { return std::span(least_).first(size_); }

 private:
  std::array<Candidate, VertexHierarchy::kParents> least_{};
  std::size_t size_ = 0;
};

/// Builds the hierarchy depth by depth, finest first; the lists are turned round at the end.
class Builder {
 public:
  explicit Builder(const DeformableObject& object) : rest_(object.rest), distance_(object.rest), mark_(rest_.size(), kNone) {}

  CodingOrder build(Graph graph) {
    CodingOrder out;
    out.depth.assign(rest_.size(), 0);
    for (;;) {
      const Flags kept = independent_set(graph);
      const bool last =
          depths_.size() + 1 == VertexHierarchy::kDepths || std::find(kept.begin(), kept.end(), std::uint8_t{0}) == kept.end();
      depths_.emplace_back();
      std::fill(mark_.begin(), mark_.begin() + static_cast<std::ptrdiff_t>(graph.vertex.size()), kNone);
      for (std::uint32_t v = 0; v < graph.vertex.size(); ++v) {
        if (kept[v] && !last) continue;
        depths_.back().vertices.push_back(graph.vertex[v]);
        out.depth[graph.vertex[v]] = static_cast<std::uint8_t>(depths_.size() - 1);
        if (!last) find_nearest(graph, kept, v);
        depths_.back().near.close();
      }
      if (last) break;
      graph = coarser(graph, kept);
    }
    collect(out);
    return out;
  }

 private:
  struct Depth {
    std::vector<std::uint32_t> vertices;
    ListOfLists<std::uint32_t> near;
  };

  /// The nearest vertices among those that are kept, or dropped but earlier, within two edges. At most kVisits are looked at.
  /// A copy of the vertex needs no others beside it.
  void find_nearest(const Graph& g, const Flags& kept, std::uint32_t v) {
    constexpr std::size_t kVisits = 64;
    nearest_.clear();
    std::size_t visits = 0;
    mark_[v] = v;
    const Vec3i& place = rest_[g.vertex[v]];
    const auto visit = [&](std::span<const std::uint32_t> list) {
      const std::size_t count = std::min(kVisits - visits, list.size());
      for (const std::uint32_t n : list.first(count)) {
        if (mark_[n] == v) continue;
        mark_[n] = v;
        if (kept[n] || n < v) nearest_.put(distance_(place, rest_[g.vertex[n]]) << kVertexBits | g.vertex[n]);
      }
      visits += count;
    };
    const auto ring = g.neighbours[v];
    visit(ring);
    for (std::size_t i = 0; i < ring.size() && visits < kVisits; ++i) visit(g.neighbours[ring[i]]);
    auto found = nearest_.get();
    if (rest_[vertex_of(found.front())] == place) found = found.first(1);
    for (const Candidate c : found) depths_.back().near.items.push_back(vertex_of(c));
  }

  /// By vertex of the graph: the place among the kept of itself, or of the nearest kept neighbour.
  std::vector<std::uint32_t> groups(const Graph& g, const Flags& kept) const {
    std::vector<std::uint32_t> number(g.vertex.size(), 0), group(g.vertex.size());
    std::exclusive_scan(kept.begin(), kept.end(), number.begin(), 0u);
    for (std::uint32_t v = 0; v < g.vertex.size(); ++v) {
      group[v] = number[v];
      if (kept[v]) continue;
      std::pair<std::uint64_t, std::uint32_t> nearest{~std::uint64_t{0}, v};
      for (const std::uint32_t n : g.neighbours[v])
        if (kept[n]) nearest = std::min(nearest, {distance_(rest_[g.vertex[v]], rest_[g.vertex[n]]), n});
      group[v] = number[nearest.second];
    }
    return group;
  }

  /// Every dropped vertex joins its nearest kept neighbour; groups with an edge between them are neighbours.
  Graph coarser(const Graph& g, const Flags& kept) {
    Graph out;
    for (std::uint32_t v = 0; v < g.vertex.size(); ++v)
      if (kept[v]) out.vertex.push_back(g.vertex[v]);
    const std::vector<std::uint32_t> group = groups(g, kept);
    std::vector<std::uint32_t> first(out.vertex.size() + 1, 0), members(g.vertex.size());
    for (const std::uint32_t i : group) ++first[i];
    std::inclusive_scan(first.begin(), first.end(), first.begin());
    for (std::uint32_t v = 0; v < g.vertex.size(); ++v) members[--first[group[v]]] = v;
    std::fill(mark_.begin(), mark_.begin() + static_cast<std::ptrdiff_t>(out.vertex.size()), kNone);
    auto& items = out.neighbours.items;
    for (std::uint32_t i = 0; i < out.vertex.size(); ++i) {
      mark_[i] = i;
      for (std::uint32_t m = first[i]; m < first[i + 1]; ++m) {
        for (const std::uint32_t n : g.neighbours[members[m]]) {
          if (mark_[group[n]] == i) continue;
          mark_[group[n]] = i;
          items.push_back(group[n]);
        }
      }
      std::sort(items.begin() + out.neighbours.first.back(), items.end());
      out.neighbours.close();
    }
    return out;
  }

  void collect(CodingOrder& out) const {
    std::size_t items = 0;
    for (const Depth& d : depths_) items += d.near.items.size();
    out.order.reserve(rest_.size());
    out.near.first.reserve(rest_.size() + 1);
    out.near.items.reserve(items);
    for (std::size_t l = depths_.size(); l-- > 0;) {
      const Depth& d = depths_[l];
      out.order.insert(out.order.end(), d.vertices.begin(), d.vertices.end());
      const auto base = static_cast<std::uint32_t>(out.near.items.size());
      for (std::size_t i = 0; i < d.near.size(); ++i) out.near.first.push_back(base + d.near.first[i + 1]);
      out.near.items.insert(out.near.items.end(), d.near.items.begin(), d.near.items.end());
    }
  }

  static constexpr std::uint32_t kNone = 0xffffffff;

  std::span<const Vec3i> rest_;
  RestDistance distance_;
  Nearest nearest_;
  std::vector<std::uint32_t> mark_;  // who saw a vertex of the graph at hand last
  std::vector<Depth> depths_;
};

}  // namespace

CodingOrder coding_order(const DeformableObject& object) {
  Graph graph;
  graph.vertex.resize(object.rest.size());
  std::iota(graph.vertex.begin(), graph.vertex.end(), 0u);
  graph.neighbours = neighbours(object);
  return Builder(object).build(std::move(graph));
}

}  // namespace tactus
