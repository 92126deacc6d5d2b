// SPDX-License-Identifier: Apache-2.0
#include "sim/surface/surface_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>

#include "sim/surface/openmesh_io.h"
#include "sim/surface/surface_text.h"

namespace tactus {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{512} << 20;
constexpr std::size_t kMaxCorners = 1024;  // trying each as the fan's first is quadratic

tl::unexpected<SurfaceError> broken(Errc code, const char* rule, std::string detail) {
  return tl::unexpected(SurfaceError{fail(code, rule).value(), {}, 0, std::move(detail)});
}

/// The name's ending in small letters.
std::string format_of(const std::string& path) {
  std::string format = std::filesystem::path(path).extension().string();
  std::transform(format.begin(), format.end(), format.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return format;
}

tl::expected<std::string, SurfaceError> read_text(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return broken(Errc::io, "R-SRF-1", "a folder");
  std::ifstream in(path, std::ios::binary);
  std::string text;
  std::array<char, 1 << 16> piece{};
  while (in) {
    in.read(piece.data(), piece.size());
    text.append(piece.data(), static_cast<std::size_t>(in.gcount()));
    if (text.size() > kMaxFileBytes) return broken(Errc::limit_exceeded, "R-SRF-2", "");
  }
  if (!in.eof() || in.bad()) return broken(Errc::io, "R-SRF-1", "");
  return text;
}

/// Twice the area, along the normal (Newell).
Vec3 polygon_normal(const std::vector<Vec3>& vertices, const Polygon& polygon) {
  Vec3 sum;
  const Vec3& origin = vertices[polygon[0]];
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum = sum + cross(vertices[polygon[i - 1]] - origin, vertices[polygon[i]] - origin);
  return sum;
}

/// Triangles from one corner to every edge, from the first corner where each looks the way the polygon does.   out  false: there is none
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

tl::expected<void, SurfaceError> append(const Polygon& polygon, std::size_t face, SurfaceFile& file) {
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

std::string of(std::size_t read, std::size_t announced, const char* noun) {
  return std::to_string(read) + " of " + std::to_string(announced) + ' ' + noun;
}

}  // namespace

tl::expected<SurfaceFile, SurfaceError> parse_surface(std::string_view text, std::string_view format) {
  const auto prepared = prepare_surface(text, format);
  if (!prepared) return tl::unexpected(prepared.error());
  if (prepared->faces == 0) return broken(Errc::invalid, "R-SRF-7", "");
  auto soup = openmesh_read(prepared->text, prepared->format);
  if (!soup) return broken(Errc::malformed, "R-SRF-4", soup.error());
  if (prepared->vertices && soup->vertices.size() != *prepared->vertices)
    return broken(Errc::malformed, "R-SRF-5", of(soup->vertices.size(), *prepared->vertices, "vertices"));
  if (soup->polygons.size() != prepared->faces)
    return broken(Errc::malformed, "R-SRF-5", of(soup->polygons.size(), prepared->faces, "faces"));
  SurfaceFile file;
  file.mesh.vertices = std::move(soup->vertices);
  for (std::size_t f = 0; f < soup->polygons.size(); ++f)
    if (auto appended = append(soup->polygons[f], f, file); !appended) return tl::unexpected(appended.error());
  const auto checked = check(file.mesh);
  if (!checked) return tl::unexpected(SurfaceError{checked.error().error, {}, checked.error().element, {}});
  drop_unused_vertices(file);
  return file;
}

tl::expected<SurfaceFile, SurfaceError> read_surface(const std::string& path) {
  const auto named = [&](SurfaceError e) {
    e.file = path;
    return e;
  };
  const auto text = read_text(path);
  if (!text) return tl::unexpected(named(text.error()));
  return parse_surface(*text, format_of(path)).map_error(named);
}

tl::expected<void, SurfaceError> write_surface(const std::string& path, const TriMesh& mesh) {
  const auto text = openmesh_write(mesh, format_of(path));
  if (!text) return tl::unexpected(SurfaceError{fail(Errc::unsupported, "R-SRF-3").value(), path, 0, {}});
  std::ofstream out(path, std::ios::binary);
  out << *text;
  out.close();
  if (!out) return tl::unexpected(SurfaceError{fail(Errc::io, "R-SRF-1").value(), path, 0, {}});
  return {};
}

}  // namespace tactus
