// SPDX-License-Identifier: Apache-2.0
#include <tactus/mesh/graph.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>

#include <tactus/mesh/kriging.h>

namespace tactus {

// ==== coding order ====

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
    const Vec3i& position = rest_[g.vertex[v]];
    const auto visit = [&](std::span<const std::uint32_t> list) {
      const std::size_t count = std::min(kVisits - visits, list.size());
      for (const std::uint32_t n : list.first(count)) {
        if (mark_[n] == v) continue;
        mark_[n] = v;
        if (kept[n] || n < v) nearest_.put(distance_(position, rest_[g.vertex[n]]) << kVertexBits | g.vertex[n]);
      }
      visits += count;
    };
    const auto ring = g.neighbours[v];
    visit(ring);
    for (std::size_t i = 0; i < ring.size() && visits < kVisits; ++i) visit(g.neighbours[ring[i]]);
    auto found = nearest_.get();
    if (rest_[vertex_of(found.front())] == position) found = found.first(1);
    for (const Candidate c : found) depths_.back().near.items.push_back(vertex_of(c));
  }

  /// By vertex of the graph: the index among the kept of itself, or of the nearest kept neighbour.
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

// ==== graph ====

namespace {

using Pair = std::array<std::uint32_t, 2>;

/// Consecutive ones among the vertices at one rest position. Programs split a vertex where texture or normals jump: the copies have
/// no triangle in common, but move together.
std::vector<Pair> seams(const DeformableObject& object) {
  struct SortKey {
    std::uint64_t xy, z_vertex;
  };
  const auto bits = [](std::int32_t c) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(c)); };
  std::vector<SortKey> keys;
  keys.reserve(object.rest.size());
  for (std::size_t v = 0; v < object.rest.size(); ++v)
    keys.push_back({bits(object.rest[v][0]) << 32 | bits(object.rest[v][1]), bits(object.rest[v][2]) << 32 | v});
  std::sort(keys.begin(), keys.end(),
            [](const SortKey& a, const SortKey& b) { return a.xy != b.xy ? a.xy < b.xy : a.z_vertex < b.z_vertex; });
  std::vector<Pair> out;
  for (std::size_t i = 1; i < keys.size(); ++i) {
    const SortKey &a = keys[i - 1], &b = keys[i];
    if (a.xy == b.xy && a.z_vertex >> 32 == b.z_vertex >> 32)
      out.push_back({static_cast<std::uint32_t>(a.z_vertex), static_cast<std::uint32_t>(b.z_vertex)});
  }
  return out;
}

/// Lists from pairs (list, item) that `visit` hands out twice, in the same order.
template <class Visit>
ListOfLists<std::uint32_t> lists_of(std::size_t lists, Visit visit) {
  ListOfLists<std::uint32_t> out;
  out.first.assign(lists + 1, 0);
  visit([&](std::uint32_t list, std::uint32_t) { ++out.first[list + 1]; });
  for (std::size_t i = 0; i < lists; ++i) out.first[i + 1] += out.first[i];
  out.items.resize(out.first[lists]);
  std::vector<std::uint32_t> next(out.first.begin(), out.first.end() - 1);
  visit([&](std::uint32_t list, std::uint32_t item) { out.items[next[list]++] = item; });
  return out;
}

/// Every list ascending and without repetition.
void tidy(Neighbours& lists) {
  std::uint32_t kept = 0, begin = 0;
  for (std::size_t i = 0; i < lists.size(); ++i) {
    const std::uint32_t end = lists.first[i + 1];
    const auto from = lists.items.begin() + begin, to = lists.items.begin() + end;
    std::sort(from, to);
    const auto last = std::unique(from, to);
    std::move(from, last, lists.items.begin() + kept);
    kept += static_cast<std::uint32_t>(last - from);
    lists.first[i + 1] = kept;
    begin = end;
  }
  lists.items.resize(kept);
}

}  // namespace

Neighbours neighbours(const DeformableObject& object) {
  const std::vector<Pair> copies = seams(object);
  Neighbours out = lists_of(object.rest.size(), [&](auto add) {
    const auto edge = [&](std::uint32_t a, std::uint32_t b) {
      add(a, b);
      add(b, a);
    };
    for (const auto& [a, b] : copies) edge(a, b);
    for (const Triangle& t : object.triangles)
      for (std::size_t k = 0; k < 3; ++k) edge(t[k], t[(k + 1) % 3]);
  });
  tidy(out);
  return out;
}

VertexHierarchy vertex_hierarchy(const DeformableObject& object) {
  CodingOrder order = coding_order(object);
  std::vector<ListOfLists<VertexParent>> parents;
  for (unsigned set = 0; set < DeformableObject::kWeightSets; ++set)
    if (object.weight_sets >> set & 1) parents.push_back(weighted_parents(object, order, set));
  return {std::move(order.order), std::move(order.depth), std::move(parents)};
}

Rings::Rings(const DeformableObject& object)
    : corners_(object.triangles), triangle_mark_(object.triangles.size()), vertex_mark_(object.rest.size()) {
  triangles_of_ = lists_of(object.rest.size(), [&](auto add) {
    for (std::uint32_t t = 0; t < object.triangles.size(); ++t)
      for (const std::uint32_t v : object.triangles[t]) add(v, t);
  });
  triangles_.reserve(object.triangles.size());
  vertices_.reserve(object.rest.size());
}

void Rings::add_corners(std::uint32_t triangle) noexcept {
  for (const std::uint32_t v : corners_[triangle]) {
    if (vertex_mark_[v] == mark_) continue;
    vertex_mark_[v] = mark_;
    vertices_.push_back(v);
  }
}

std::span<const std::uint32_t> Rings::triangles_around(std::uint32_t triangle, std::uint32_t rings) noexcept {
  if (++mark_ == 0) {
    std::fill(triangle_mark_.begin(), triangle_mark_.end(), 0u);
    std::fill(vertex_mark_.begin(), vertex_mark_.end(), 0u);
    mark_ = 1;
  }
  triangles_.clear();
  vertices_.clear();
  triangles_.push_back(triangle);
  triangle_mark_[triangle] = mark_;
  add_corners(triangle);
  std::size_t grown = 0;  // vertices whose triangles are all in
  for (std::uint32_t r = 0; r < rings; ++r) {
    const std::size_t rim = vertices_.size(), inner = triangles_.size();
    for (; grown < rim; ++grown) {
      for (const std::uint32_t t : triangles_of_[vertices_[grown]]) {
        if (triangle_mark_[t] == mark_) continue;
        triangle_mark_[t] = mark_;
        triangles_.push_back(t);
      }
    }
    for (std::size_t i = inner; i < triangles_.size(); ++i) add_corners(triangles_[i]);
  }
  return triangles_;
}

}  // namespace tactus
