// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/tri_mesh.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <tactus/base/rule.h>

namespace tactus {
namespace {

constexpr double kMaxCoordinate = 1e6;  // [m]

/// One side of an edge as a number that sorts by lower vertex, higher vertex, triangle, corner: 20 + 20 + 23 bits.
using EdgeSide = std::uint64_t;
static_assert(kMaxMeshVertices <= std::size_t{1} << 20 && 3 * kMaxMeshTriangles <= std::size_t{1} << 23);

constexpr EdgeSide edge_of(EdgeSide side) noexcept { return side >> 23; }
constexpr std::uint32_t low_vertex(EdgeSide side) noexcept { return static_cast<std::uint32_t>(side >> 43); }
constexpr std::uint32_t corner_of(EdgeSide side) noexcept {
  return static_cast<std::uint32_t>(side & 0x7fffff);
}  // 3 triangle + k

std::vector<EdgeSide> sorted_sides(const TriMesh& mesh) {
  std::vector<EdgeSide> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
      sides.push_back(EdgeSide{low} << 43 | EdgeSide{high} << 23 | (3 * t + k));
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

tl::unexpected<Diagnostic> broken(RuleName rule, const char* kind, std::size_t element) {
  return tl::unexpected(Diagnostic{.error = fail(Errc::invalid, rule).value(), .kind = kind, .element = element});
}

bool is_in_range(const Vec3& v) noexcept {  // false for NaN
  return std::abs(v.x) <= kMaxCoordinate && std::abs(v.y) <= kMaxCoordinate && std::abs(v.z) <= kMaxCoordinate;
}

tl::expected<void, Diagnostic> check_elements(const TriMesh& mesh) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!is_in_range(mesh.vertices[v])) return broken("R-SRF-8", "vertex", v);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (v >= mesh.vertices.size()) return broken("R-SRF-9", "triangle", t);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    const Vec3& origin = mesh.vertices[a];
    const bool repeated = a == b || b == c || c == a;
    if (repeated || cross(mesh.vertices[b] - origin, mesh.vertices[c] - origin) == Vec3{})
      return broken("R-SRF-10", "triangle", t);
  }
  return {};
}

/// True where the edge is walked from its lower vertex to its higher one.
bool is_upward(const TriMesh& mesh, EdgeSide side) noexcept {
  return mesh.triangles[corner_of(side) / 3][corner_of(side) % 3] == low_vertex(side);
}

tl::expected<void, Diagnostic> check_edges(const TriMesh& mesh) {
  const std::vector<EdgeSide> sides = sorted_sides(mesh);
  std::uint32_t third = MeshTopology::kNone, turned = MeshTopology::kNone;
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (edge_of(sides[i]) != edge_of(sides[i - 1])) continue;
    const std::uint32_t triangle = corner_of(sides[i]) / 3;
    if (i >= 2 && edge_of(sides[i]) == edge_of(sides[i - 2])) third = std::min(third, triangle);
    if (is_upward(mesh, sides[i]) == is_upward(mesh, sides[i - 1])) turned = std::min(turned, triangle);
  }
  if (third != MeshTopology::kNone) return broken("R-SRF-11", "triangle", third);
  if (turned != MeshTopology::kNone) return broken("R-SRF-12", "triangle", turned);
  return {};
}

std::uint32_t corner_at(const TriMesh& mesh, std::uint32_t triangle, std::uint32_t vertex) noexcept {
  const Triangle& t = mesh.triangles[triangle];
  return t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
}

/// Triangles of the fan around `vertex` that holds `first`.
std::size_t fan_size(const TriMesh& mesh, const MeshTopology& topology, std::uint32_t vertex, std::uint32_t first) {
  std::size_t count = 1;
  for (const std::uint32_t side : {2U, 0U}) {  // counter-clockwise across the edge that ends here; from a boundary the other way
    std::uint32_t t = first;
    while (true) {
      t = topology.across(t, (corner_at(mesh, t, vertex) + side) % 3);
      if (t == first) return count;
      if (t == MeshTopology::kNone) break;
      ++count;
    }
  }
  return count;
}

tl::expected<void, Diagnostic> check_fans(const TriMesh& mesh) {
  const MeshTopology topology(mesh);
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const auto triangles = topology.triangles_of(v);
    if (!triangles.empty() && fan_size(mesh, topology, v, triangles[0]) != triangles.size())
      return broken("R-SRF-13", "vertex", v);
  }
  return {};
}

/// Turn counts per vertex into where each vertex's part of a common list starts; the last entry is the list's length.
void accumulate(std::vector<std::uint32_t>& first) { std::exclusive_scan(first.begin(), first.end(), first.begin(), 0U); }

}  // namespace

tl::expected<void, Diagnostic> check(const TriMesh& mesh) try {
  if (mesh.vertices.size() > kMaxMeshVertices || mesh.triangles.size() > kMaxMeshTriangles)
    return tl::unexpected(Diagnostic{fail(Errc::limit_exceeded, "R-SRF-14").value()});
  return check_elements(mesh).and_then([&] { return check_edges(mesh); }).and_then([&] { return check_fans(mesh); });
} catch (const std::bad_alloc&) {
  return tl::unexpected(Diagnostic{out_of_memory().value()});
}

MeshTopology::MeshTopology(const TriMesh& mesh)
    : first_triangle_(mesh.vertices.size() + 1, 0),
      triangle_list_(3 * mesh.triangles.size()),
      corners_(mesh.triangles),
      across_(mesh.triangles.size(), {kNone, kNone, kNone}) {
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) ++first_triangle_[v];
  accumulate(first_triangle_);
  std::vector<std::uint32_t> end = first_triangle_;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) triangle_list_[end[v]++] = t;

  const std::vector<EdgeSide> sides = sorted_sides(mesh);
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (edge_of(sides[i]) != edge_of(sides[i - 1])) continue;
    const std::uint32_t a = corner_of(sides[i - 1]), b = corner_of(sides[i]);
    across_[a / 3][a % 3] = b / 3;
    across_[b / 3][b % 3] = a / 3;
  }
}

std::span<const std::uint32_t> MeshTopology::triangles_of(std::uint32_t vertex) const noexcept {
  return std::span(triangle_list_).subspan(first_triangle_[vertex], first_triangle_[vertex + 1] - first_triangle_[vertex]);
}

void MeshTopology::rings_around(std::uint32_t triangle, unsigned rings, std::vector<std::uint32_t>& out) const {
  const auto sort_from = [&out](std::ptrdiff_t start) {
    std::sort(out.begin() + start, out.end());
    out.erase(std::unique(out.begin() + start, out.end()), out.end());
  };
  out.assign(1, triangle);
  std::ptrdiff_t before = 0, ring = 0;  // where the last ring but one and the last one start, each ascending
  for (unsigned r = 0; r < rings; ++r) {
    const auto next = std::ssize(out);
    for (auto i = ring; i < next; ++i)
      out.insert(out.end(), corners_[out[static_cast<std::size_t>(i)]].begin(), corners_[out[static_cast<std::size_t>(i)]].end());
    sort_from(next);
    const auto corners_end = std::ssize(out);
    for (auto i = next; i < corners_end; ++i) {
      const auto around = triangles_of(out[static_cast<std::size_t>(i)]);
      out.insert(out.end(), around.begin(), around.end());
    }
    out.erase(out.begin() + next, out.begin() + corners_end);
    sort_from(next);
    // What touches a ring lies in it, in the one before or in the next.
    const auto is_known = [&](std::uint32_t t) {
      return std::binary_search(out.begin() + before, out.begin() + ring, t) ||
             std::binary_search(out.begin() + ring, out.begin() + next, t);
    };
    out.erase(std::remove_if(out.begin() + next, out.end(), is_known), out.end());
    if (std::ssize(out) == next) return;
    before = std::exchange(ring, next);
  }
}

}  // namespace tactus
