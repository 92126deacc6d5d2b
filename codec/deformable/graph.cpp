// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/graph.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include <tactus/base/fixed.h>

namespace tactus {
namespace {

using Edge = std::uint64_t;  // two vertices, sorted by the first

constexpr Edge edge(std::uint32_t a, std::uint32_t b) noexcept { return Edge{a} << 32 | b; }

/// Neighbour lists, ascending and without repetition, from edges in both directions.
Neighbours lists_from(std::vector<Edge>& edges, std::size_t vertices) {
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  Neighbours out;
  out.first.reserve(vertices + 1);
  out.items.reserve(edges.size());
  std::size_t at = 0;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    for (; at < edges.size() && edges[at] >> 32 == v; ++at) out.items.push_back(static_cast<std::uint32_t>(edges[at]));
    out.close();
  }
  return out;
}

/// Programs split a vertex where texture or normals jump. The copies have no triangle in common, but move together.
void add_seams(const DeformableObject& object, std::vector<Edge>& edges) {
  std::vector<std::uint32_t> by_place(object.rest.size());
  std::iota(by_place.begin(), by_place.end(), 0u);
  std::sort(by_place.begin(), by_place.end(), [&](std::uint32_t a, std::uint32_t b) {
    return object.rest[a] != object.rest[b] ? object.rest[a] < object.rest[b] : a < b;
  });
  for (std::size_t i = 1; i < by_place.size(); ++i) {
    const std::uint32_t a = by_place[i - 1], b = by_place[i];
    if (object.rest[a] != object.rest[b]) continue;
    edges.push_back(edge(a, b));
    edges.push_back(edge(b, a));
  }
}

/// Squared distances of rest positions on a grid so coarse that they fit 38 bits.
class Distances {
 public:
  explicit Distances(const DeformableObject& object) : rest_(object.rest) {
    std::uint64_t extent = 0;
    for (std::size_t axis = 0; axis < 3 && !rest_.empty(); ++axis) {
      const auto [low, high] =
          std::minmax_element(rest_.begin(), rest_.end(), [axis](const Vec3i& a, const Vec3i& b) { return a[axis] < b[axis]; });
      extent = std::max(extent, static_cast<std::uint64_t>(static_cast<std::int64_t>((*high)[axis]) - (*low)[axis]));
    }
    const auto width = static_cast<unsigned>(std::bit_width(extent));
    shift_ = width > 18 ? width - 18 : 0;
  }
  std::uint64_t operator()(std::uint32_t a, std::uint32_t b) const noexcept {
    std::uint64_t sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t d = (static_cast<std::int64_t>(rest_[a][axis]) - rest_[b][axis]) >> shift_;
      sum += static_cast<std::uint64_t>(d * d);
    }
    return std::max<std::uint64_t>(sum, 1);
  }

 private:
  std::span<const Vec3i> rest_;
  unsigned shift_ = 0;
};

/// One graph of the hierarchy. Its vertices are numbered 0.. in the order of the mesh's; `vertex` gives the mesh's number.
struct Graph {
  std::vector<std::uint32_t> vertex;
  Neighbours neighbours;
};

/// Greedy maximal independent set in ascending order.
std::vector<bool> independent_set(const Graph& g) {
  std::vector<bool> kept(g.vertex.size(), false), dropped(g.vertex.size(), false);
  for (std::size_t v = 0; v < g.vertex.size(); ++v) {
    if (dropped[v]) continue;
    kept[v] = true;
    for (const std::uint32_t n : g.neighbours[v]) dropped[n] = true;
  }
  return kept;
}

struct Candidate {
  std::uint64_t distance = 0;
  std::uint32_t vertex = 0;
  friend bool operator<(const Candidate& a, const Candidate& b) noexcept {
    return a.distance != b.distance ? a.distance < b.distance : a.vertex < b.vertex;
  }
  friend bool operator==(const Candidate&, const Candidate&) = default;
};

/// Builds the hierarchy depth by depth, finest first; the lists are turned round at the end.
class HierarchyBuilder {
 public:
  explicit HierarchyBuilder(const DeformableObject& object) : rest_(object.rest), distance_(object) {}

  VertexHierarchy build(Graph graph) {
    VertexHierarchy out;
    out.depth.assign(rest_.size(), 0);
    parents_.resize(rest_.size());
    std::vector<std::vector<std::uint32_t>> depths;
    for (;;) {
      const auto kept = independent_set(graph);
      const bool last = depths.size() + 1 == VertexHierarchy::kDepths || std::find(kept.begin(), kept.end(), false) == kept.end();
      depths.emplace_back();
      for (std::uint32_t v = 0; v < graph.vertex.size(); ++v) {
        if (kept[v] && !last) continue;
        depths.back().push_back(graph.vertex[v]);
        out.depth[graph.vertex[v]] = static_cast<std::uint8_t>(depths.size() - 1);
        if (!last) find_parents(graph, kept, v);
      }
      if (last) break;
      graph = coarser(graph, kept);
    }
    for (std::size_t l = depths.size(); l-- > 0;) {
      for (const std::uint32_t v : depths[l]) {
        out.order.push_back(v);
        out.parents.items.insert(out.parents.items.end(), parents_[v].begin(), parents_[v].end());
        out.parents.close();
      }
    }
    return out;
  }

 private:
  /// The nearest vertices among those that are kept, or dropped but earlier, within two edges. At most kVisits are looked at.
  /// A copy of the vertex needs no others beside it.
  void find_parents(const Graph& g, const std::vector<bool>& kept, std::uint32_t v) {
    constexpr std::size_t kVisits = 64;
    near_.clear();
    std::size_t visits = 0;
    const auto visit = [&](std::uint32_t n) {
      if (n != v && (kept[n] || n < v)) near_.push_back({distance_(g.vertex[v], g.vertex[n]), g.vertex[n]});
      return ++visits < kVisits;
    };
    const auto ring = g.neighbours[v];
    bool more = std::all_of(ring.begin(), ring.end(), visit);
    for (std::size_t i = 0; more && i < ring.size(); ++i) {
      const auto next = g.neighbours[ring[i]];
      more = std::all_of(next.begin(), next.end(), visit);
    }
    std::sort(near_.begin(), near_.end());
    near_.erase(std::unique(near_.begin(), near_.end()), near_.end());
    auto& parents = parents_[g.vertex[v]];
    if (rest_[near_.front().vertex] == rest_[g.vertex[v]]) {
      parents.push_back({near_.front().vertex, 1 << 15});
      return;
    }
    if (near_.size() > VertexHierarchy::kParents) near_.resize(VertexHierarchy::kParents);
    weigh(parents);
  }

  using Row = std::array<std::int64_t, VertexHierarchy::kParents>;

  /// How alike two vertices move, x 2^-24: (1 - r)^4 (1 + 4 r) of r^2 = distance / support_radius, 0 beyond.
  static std::int64_t covariance(std::uint64_t distance, std::uint64_t support_radius) noexcept {
    if (distance >= support_radius) return 0;
    const std::int64_t r = isqrt(((distance << 24) / support_radius) << 24);
    const std::int64_t square = ((kOne - r) * (kOne - r)) >> 24;
    return (((square * square) >> 24) * (4 * r + kOne)) >> 24;
  }

  /// Weights of best linear prediction whose sum is 1: C a = c and C b = 1, then a + b (1 - sum a) / sum b.
  void weigh(std::vector<VertexParent>& out) const {
    const std::size_t n = near_.size();
    std::uint64_t sum = 0;
    for (const Candidate& c : near_) sum += c.distance;
    const std::uint64_t support_radius = kSupportRadius * sum / n;
    std::array<Row, VertexHierarchy::kParents> matrix{};
    Row a{}, b{};
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < i; ++j) matrix[i][j] = covariance(distance_(near_[i].vertex, near_[j].vertex), support_radius);
      matrix[i][i] = kOne + kNugget;
      a[i] = covariance(near_[i].distance, support_radius);
      b[i] = kOne;
    }
    if (!solve(matrix, n, a, b)) {
      out.push_back({near_.front().vertex, 1 << 15});
      return;
    }
    std::int64_t sum_a = 0, sum_b = 0;
    for (std::size_t i = 0; i < n; ++i) {
      sum_a += a[i];
      sum_b += b[i];
    }
    for (std::size_t i = 0; i < n; ++i) {
      const std::int64_t share = bounded(round_div(b[i] << 24, std::max(sum_b, kLeastPivot)), kMostShare);
      const std::int64_t rest = bounded(kOne - sum_a, 1 << 26);
      const std::int64_t weight = round_shift(a[i] + round_shift(share * rest, 24), 9);
      out.push_back({near_[i].vertex, static_cast<std::int32_t>(std::clamp<std::int64_t>(weight, -65536, 65536))});
    }
  }

  static constexpr std::int64_t bounded(std::int64_t v, std::int64_t limit) noexcept { return std::clamp(v, -limit, limit); }

  /// Solves for both right sides by L D L^T of the lower triangle. False: the matrix is not positive definite, which happens where
  /// vertices (nearly) coincide. Otherwise the noise term on the diagonal keeps all pivots large, and no clamp acts: they only keep
  /// products within 63 bits.
  static bool solve(std::array<Row, VertexHierarchy::kParents>& m, std::size_t n, Row& a, Row& b) noexcept {
    for (std::size_t j = 0; j < n; ++j) {
      if (m[j][j] < kLeastPivot) return false;
      for (std::size_t i = j + 1; i < n; ++i) {
        const std::int64_t factor = bounded(round_div(m[i][j] << 24, m[j][j]), 1 << 28);
        for (std::size_t k = j + 1; k <= i; ++k) m[i][k] = bounded(m[i][k] - round_shift(factor * m[k][j], 24), 1 << 25);
        a[i] = bounded(a[i] - round_shift(factor * a[j], 24), kMostShare);
        b[i] = bounded(b[i] - round_shift(factor * b[j], 24), kMostShare);
      }
    }
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t k = i + 1; k < n; ++k) {
        a[i] = bounded(a[i] - round_shift(m[k][i] * a[k], 24), kMostShare);
        b[i] = bounded(b[i] - round_shift(m[k][i] * b[k], 24), kMostShare);
      }
      a[i] = bounded(round_div(a[i] << 24, m[i][i]), kMostShare);
      b[i] = bounded(round_div(b[i] << 24, m[i][i]), kMostShare);
    }
    return true;
  }

  /// Every dropped vertex joins its nearest kept neighbour; groups with an edge between them are neighbours.
  Graph coarser(const Graph& g, const std::vector<bool>& kept) const {
    Graph out;
    std::vector<std::uint32_t> number(g.vertex.size(), 0), group(g.vertex.size());
    for (std::uint32_t v = 0; v < g.vertex.size(); ++v) {
      if (!kept[v]) continue;
      number[v] = static_cast<std::uint32_t>(out.vertex.size());
      out.vertex.push_back(g.vertex[v]);
    }
    for (std::uint32_t v = 0; v < g.vertex.size(); ++v) {
      Candidate nearest{~std::uint64_t{0}, v};
      for (const std::uint32_t n : g.neighbours[v])
        if (!kept[v] && kept[n]) nearest = std::min(nearest, Candidate{distance_(g.vertex[v], g.vertex[n]), n});
      group[v] = number[nearest.vertex];
    }
    std::vector<Edge> edges;
    edges.reserve(g.neighbours.items.size());
    for (std::uint32_t v = 0; v < g.vertex.size(); ++v)
      for (const std::uint32_t n : g.neighbours[v])
        if (group[v] != group[n]) edges.push_back(edge(group[v], group[n]));
    out.neighbours = lists_from(edges, out.vertex.size());
    return out;
  }

  static constexpr std::int64_t kOne = 1 << 24;
  static constexpr std::int64_t kLeastPivot = 1 << 18;
  static constexpr std::int64_t kMostShare = std::int64_t{1} << 34;
  static constexpr std::int64_t kNugget = 335544;      // 0.02: how much of a parent's movement is its own
  static constexpr std::uint64_t kSupportRadius = 94;  // squared, in mean squared distances of the parents

  std::span<const Vec3i> rest_;
  Distances distance_;
  std::vector<Candidate> near_;
  std::vector<std::vector<VertexParent>> parents_;
};

}  // namespace

Neighbours neighbours(const DeformableObject& object) {
  std::vector<Edge> edges;
  edges.reserve(6 * object.triangles.size());
  add_seams(object, edges);
  for (const Triangle& t : object.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      edges.push_back(edge(t[k], t[(k + 1) % 3]));
      edges.push_back(edge(t[(k + 1) % 3], t[k]));
    }
  }
  return lists_from(edges, object.rest.size());
}

VertexHierarchy vertex_hierarchy(const DeformableObject& object) {
  Graph graph;
  for (std::uint32_t v = 0; v < object.rest.size(); ++v) graph.vertex.push_back(v);
  graph.neighbours = neighbours(object);
  return HierarchyBuilder(object).build(std::move(graph));
}

Rings::Rings(const DeformableObject& object)
    : corners_(object.triangles), triangle_mark_(object.triangles.size()), vertex_mark_(object.rest.size()) {
  std::vector<Edge> pairs;
  pairs.reserve(3 * object.triangles.size());
  for (std::uint32_t t = 0; t < object.triangles.size(); ++t)
    for (const std::uint32_t v : object.triangles[t]) pairs.push_back(edge(v, t));
  triangles_of_ = lists_from(pairs, object.rest.size());
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
