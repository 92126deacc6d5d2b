// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/tets/tet_mesh.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <tactus/base/rule.h>

namespace tactus::sim {

// ==== tet mesh ====

namespace {

using Face = std::array<std::uint32_t, 3>;

/// Faces of a tetrahedron, counter-clockwise seen from outside.
std::array<Face, 4> faces(const Tet& t) {
  return {{{t[0], t[2], t[1]}, {t[0], t[1], t[3]}, {t[1], t[2], t[3]}, {t[0], t[3], t[2]}}};
}

constexpr double kMaxCoordinate = 1e6;     // [m]
constexpr double kSmallestVolume = 1e-12;  // of the longest edge's cube

tl::unexpected<Diagnostic> broken(RuleName rule, const char* kind, std::size_t element) {
  return tl::unexpected(Diagnostic{.error = fail(Errc::invalid, rule).value(), .kind = kind, .element = element});
}

bool is_in_range(const Vec3& v) noexcept {  // false for NaN
  return std::abs(v.x) <= kMaxCoordinate && std::abs(v.y) <= kMaxCoordinate && std::abs(v.z) <= kMaxCoordinate;
}

bool is_flat(const TetMesh& mesh, std::size_t tet) noexcept {  // also when a corner occurs twice
  double longest = 0;
  const Tet& corners = mesh.tets[tet];
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < i; ++k) longest = std::max(longest, norm(mesh.vertices[corners[i]] - mesh.vertices[corners[k]]));
  return std::abs(volume(mesh, tet)) <= kSmallestVolume * longest * longest * longest;
}

tl::expected<void, Diagnostic> check_elements(const TetMesh& mesh) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!is_in_range(mesh.vertices[v])) return broken("R-TET-1", "vertex", v);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (const std::uint32_t v : mesh.tets[t])
      if (v >= mesh.vertices.size()) return broken("R-TET-2", "tetrahedron", t);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    if (is_flat(mesh, t)) return broken("R-TET-3", "tetrahedron", t);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    if (volume(mesh, t) < 0) return broken("R-TET-4", "tetrahedron", t);
  return {};
}

/// A face of a tetrahedron as a number, which is the same for any order of its corners.
std::uint64_t face_key(Face face) noexcept {
  std::sort(face.begin(), face.end());
  return std::uint64_t{face[0]} << 40 | std::uint64_t{face[1]} << 20 | face[2];
}
static_assert(kMaxMeshVertices <= std::size_t{1} << 20);

/// True when the corners' order is an even permutation of the ascending one.
bool is_even(const Face& f) noexcept { return ((f[0] < f[1]) + (f[1] < f[2]) + (f[0] < f[2])) % 2 == 1; }

tl::expected<void, Diagnostic> check_faces(const TetMesh& mesh) {
  struct Side {
    std::uint64_t key;
    std::uint32_t tet;
    bool even;
  };
  std::vector<Side> sides;
  sides.reserve(4 * mesh.tets.size());
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t)
    for (const Face& face : faces(mesh.tets[t])) sides.push_back({face_key(face), t, is_even(face)});
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.key != b.key ? a.key < b.key : a.tet < b.tet; });
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t first = kNone;
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (sides[i].key != sides[i - 1].key) continue;
    const bool third = i >= 2 && sides[i].key == sides[i - 2].key;
    if (third || sides[i].even == sides[i - 1].even) first = std::min(first, sides[i].tet);
  }
  if (first != kNone) return broken("R-TET-5", "tetrahedron", first);
  return {};
}

tl::expected<void, Diagnostic> check_use(const TetMesh& mesh) {
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Tet& tet : mesh.tets)
    for (const std::uint32_t v : tet) used[v] = true;
  const auto unused = std::find(used.begin(), used.end(), false);
  if (unused != used.end()) return broken("R-TET-6", "vertex", static_cast<std::size_t>(unused - used.begin()));
  return {};
}

}  // namespace

double volume(const TetMesh& mesh, std::size_t tet) noexcept {
  const auto& [a, b, c, d] = mesh.tets[tet];
  const Vec3& origin = mesh.vertices[a];
  return dot(cross(mesh.vertices[b] - origin, mesh.vertices[c] - origin), mesh.vertices[d] - origin) / 6;
}

Bounds bounds(std::span<const Vec3> points) noexcept {
  if (points.empty()) return {};
  Bounds box{points[0], points[0]};
  for (const Vec3& p : points) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  return box;
}

tl::expected<void, Diagnostic> check(const TetMesh& mesh) {
  if (mesh.vertices.size() > kMaxMeshVertices || mesh.tets.size() > kMaxTets)
    return tl::unexpected(Diagnostic{fail(Errc::limit_exceeded, "R-TET-7").value()});
  return check_elements(mesh).and_then([&] { return check_faces(mesh); }).and_then([&] { return check_use(mesh); });
}

TetSurface surface(const TetMesh& mesh) {
  struct Side {
    Face key, face;  // sorted, as seen from outside
  };
  std::vector<Side> sides;
  sides.reserve(4 * mesh.tets.size());
  for (const Tet& tet : mesh.tets) {
    for (const Face& face : faces(tet)) {
      Face key = face;
      std::sort(key.begin(), key.end());
      sides.push_back({key, face});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.key < b.key; });

  TetSurface out;
  std::vector<std::uint32_t> number(mesh.vertices.size(), 0);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i + 1 < sides.size() && sides[i].key == sides[i + 1].key) {
      ++i;
      continue;
    }
    out.mesh.triangles.push_back(sides[i].face);
    for (const std::uint32_t v : sides[i].face) number[v] = 1;
  }
  for (std::uint32_t v = 0; v < number.size(); ++v) {
    if (number[v] == 0) continue;
    number[v] = static_cast<std::uint32_t>(out.vertex.size());
    out.vertex.push_back(v);
    out.mesh.vertices.push_back(mesh.vertices[v]);
  }
  for (Triangle& triangle : out.mesh.triangles)
    for (std::uint32_t& v : triangle) v = number[v];
  return out;
}

TetMesh make_slab(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz, double cell) {
  TetMesh mesh;
  for (std::uint32_t k = 0; k <= nz; ++k)
    for (std::uint32_t j = 0; j <= ny; ++j)
      for (std::uint32_t i = 0; i <= nx; ++i) mesh.vertices.push_back({cell * i, cell * j, cell * k});

  const std::uint32_t x = 1, y = nx + 1, z = (nx + 1) * (ny + 1);
  for (std::uint32_t k = 0; k < nz; ++k) {
    for (std::uint32_t j = 0; j < ny; ++j) {
      for (std::uint32_t i = 0; i < nx; ++i) {
        const std::uint32_t o = i * x + j * y + k * z, far = o + x + y + z;
        // One tetrahedron for each order in which the diagonal can be walked along the axes; odd orders are mirrored.
        mesh.tets.push_back({o, o + x, o + x + y, far});
        mesh.tets.push_back({o, o + x, far, o + x + z});
        mesh.tets.push_back({o, o + y, far, o + x + y});
        mesh.tets.push_back({o, o + y, o + y + z, far});
        mesh.tets.push_back({o, o + z, o + x + z, far});
        mesh.tets.push_back({o, o + z, far, o + y + z});
      }
    }
  }
  return mesh;
}

// ==== tet quality ====

namespace {

/// Outward normals of the faces opposite to corners a, b, c, d; as long as twice the face's area.
std::array<Vec3, 4> face_normals(const TetMesh& mesh, const Tet& tet) {
  const Vec3 &a = mesh.vertices[tet[0]], &b = mesh.vertices[tet[1]], &c = mesh.vertices[tet[2]], &d = mesh.vertices[tet[3]];
  return {cross(c - b, d - b), cross(d - a, c - a), cross(b - a, d - a), cross(c - a, b - a)};
}

double shape(const TetMesh& mesh, std::size_t t) {
  double squares = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const Vec3 edge = mesh.vertices[mesh.tets[t][i]] - mesh.vertices[mesh.tets[t][k]];
      squares += dot(edge, edge);
    }
  }
  return 12 * std::cbrt(std::pow(3 * volume(mesh, t), 2)) / squares;
}

}  // namespace

TetQuality quality(const TetMesh& mesh) {
  TetQuality out{{std::numbers::pi, 0}, {0, 0}, {2, 0}, 0};
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t) {
    const std::array<Vec3, 4> normals = face_normals(mesh, mesh.tets[t]);
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const double angle = std::numbers::pi - std::atan2(norm(cross(normals[i], normals[k])), dot(normals[i], normals[k]));
        if (angle < out.smallest_angle.value) out.smallest_angle = {angle, t};
        if (angle > out.largest_angle.value) out.largest_angle = {angle, t};
      }
    }
    const double value = shape(mesh, t);
    out.mean_shape += value / static_cast<double>(mesh.tets.size());
    if (value < out.shape.value) out.shape = {value, t};
  }
  return out;
}

}  // namespace tactus::sim
