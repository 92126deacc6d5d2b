// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/surface_file.h>

#include <algorithm>
#include <fstream>

#include <tactus/base/rule.h>
#include <tactus/sim/surface/polygon_file.h>

namespace tactus::sim {
namespace {

constexpr std::size_t kMaxCorners = 1024;  // the search for a fan's first corner is quadratic

/// Twice the area, along the normal (Newell).
Vec3 polygon_normal(const std::vector<Vec3>& vertices, const Polygon& polygon) {
  Vec3 sum;
  const Vec3& origin = vertices[polygon[0]];
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum = sum + cross(vertices[polygon[i - 1]] - origin, vertices[polygon[i]] - origin);
  return sum;
}

/// Cut the polygon into a fan of triangles from the first corner where all of them face its way.   out  false: there is none
bool append_fan(const Polygon& polygon, TriMesh& mesh) {
  const std::size_t n = polygon.size();
  const Vec3 normal = polygon_normal(mesh.vertices, polygon);
  for (std::size_t first = 0; first < n; ++first) {
    const std::size_t start = mesh.triangles.size();
    for (std::size_t i = 1; i + 1 < n; ++i) {
      const Triangle t{polygon[first], polygon[(first + i) % n], polygon[(first + i + 1) % n]};
      const Vec3& origin = mesh.vertices[t[0]];
      if (dot(cross(mesh.vertices[t[1]] - origin, mesh.vertices[t[2]] - origin), normal) <= 0) break;
      mesh.triangles.push_back(t);
    }
    if (mesh.triangles.size() - start == n - 2) return true;
    mesh.triangles.resize(start);
  }
  return false;
}

tl::expected<void, Diagnostic> append(const Polygon& polygon, std::size_t face, SurfaceFile& file) {
  if (polygon.size() == 3) {
    file.mesh.triangles.push_back({polygon[0], polygon[1], polygon[2]});
    return {};
  }
  const std::string place = "face " + std::to_string(face);
  if (polygon.size() < 3 || polygon.size() > kMaxCorners) return broken(Errc::invalid, "R-SRF-6", place);
  const bool inside = std::all_of(polygon.begin(), polygon.end(), [&](std::uint32_t v) { return v < file.mesh.vertices.size(); });
  if (!inside) return broken(Errc::malformed, "R-SRF-5", place);
  if (!append_fan(polygon, file.mesh)) return broken(Errc::invalid, "R-SRF-6", place);
  ++file.polygons;
  return {};
}

/// pre  every index is that of a vertex
void drop_unused_vertices(SurfaceFile& file) {
  TriMesh& mesh = file.mesh;
  std::vector<std::uint32_t> number(mesh.vertices.size(), 0);
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) number[v] = 1;
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == 0) continue;
    mesh.vertices[kept] = mesh.vertices[v];
    number[v] = kept++;
  }
  for (Triangle& triangle : mesh.triangles)
    for (std::uint32_t& v : triangle) v = number[v];
  file.unused_vertices = mesh.vertices.size() - kept;
  mesh.vertices.resize(kept);
}

}  // namespace

tl::expected<SurfaceFile, Diagnostic> parse_surface(std::string_view text, std::string_view format) {
  TACTUS_TRY(auto soup, parse_polygons(text, format));
  return make_surface(std::move(soup));
}

tl::expected<SurfaceFile, Diagnostic> make_surface(PolygonSoup&& soup) {
  SurfaceFile file;
  file.mesh.vertices = std::move(soup.vertices);
  for (std::size_t f = 0; f < soup.polygons.size(); ++f) TACTUS_CHECK(append(soup.polygons[f], f, file));
  TACTUS_CHECK(check(file.mesh));
  drop_unused_vertices(file);
  return file;
}

tl::expected<SurfaceFile, Diagnostic> read_surface(const std::string& path) {
  TACTUS_TRY(auto soup, read_polygons(path));
  return make_surface(std::move(soup)).map_error([&](Diagnostic e) {
    e.file = path;
    return e;
  });
}

tl::expected<void, Diagnostic> write_surface(const std::string& path, const TriMesh& mesh) {
  const auto text = openmesh_write(mesh, surface_format(path));
  if (!text) return broken(Errc::unsupported, "R-SRF-3", "", path);
  std::ofstream out(path, std::ios::binary);
  out << *text;
  out.close();
  if (!out) return broken(Errc::io, "R-SRF-1", "", path);
  return {};
}

}  // namespace tactus::sim
