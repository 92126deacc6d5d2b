// SPDX-License-Identifier: Apache-2.0
// Surfaces as text whose digits read back as the same bits; STL as bytes, which holds single precision alone.
#include <bit>
#include <charconv>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include <tactus/sim/surface/polygon_file.h>

namespace tactus::sim {
namespace {

/// Three numbers with blanks between them.
template <class Number>
void line(std::string& out, Number a, Number b, Number c) {
  char digits[32];
  for (const Number value : {a, b, c}) out.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr) += ' ';
  out.back() = '\n';
}

/// `front` before each vertex and each triangle, whose corners are counted from `first`.
std::string lines(std::string out, const TriMesh& mesh, std::string_view vertex, std::string_view face, std::uint32_t first) {
  for (const Vec3& v : mesh.vertices) {
    out += vertex;
    line(out, v.x, v.y, v.z);
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    out += face;
    line(out, a + first, b + first, c + first);
  }
  return out;
}

void put(std::string& out, std::uint32_t word) {
  for (unsigned shift = 0; shift < 32; shift += 8) out += static_cast<char>(word >> shift & 0xFF);
}
void put(std::string& out, const Vec3& v) {
  for (const double c : {v.x, v.y, v.z}) put(out, std::bit_cast<std::uint32_t>(static_cast<float>(c)));
}

std::string stl_bytes(const TriMesh& mesh) {
  std::string out(80, ' ');
  put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 normal = cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]);
    put(out, 1 / norm(normal) * normal);
    for (const std::uint32_t v : {a, b, c}) put(out, mesh.vertices[v]);
    out.append(2, '\0');
  }
  return out;
}

/// Nothing: no format that is written.
std::optional<std::string> bytes_of(const TriMesh& mesh, const std::string& format) {
  const std::string vertices = std::to_string(mesh.vertices.size()), faces = std::to_string(mesh.triangles.size());
  if (format == ".obj") return lines("# " + vertices + " vertices, " + faces + " faces\n", mesh, "v ", "f ", 1);
  if (format == ".off") return lines("OFF\n" + vertices + ' ' + faces + " 0\n", mesh, "", "3 ", 0);
  if (format == ".ply")
    return lines("ply\nformat ascii 1.0\nelement vertex " + vertices +
                     "\nproperty double x\nproperty double y\nproperty double z\nelement face " + faces +
                     "\nproperty list uchar int vertex_indices\nend_header\n",
                 mesh, "", "3 ", 0);
  if (format == ".stl") return stl_bytes(mesh);
  return std::nullopt;
}

}  // namespace

tl::expected<void, Diagnostic> write_surface(const std::string& path, const TriMesh& mesh) {
  const auto bytes = bytes_of(mesh, surface_format(path));
  if (!bytes) return broken(Errc::unsupported, "R-SRF-3", "", path);
  std::ofstream out(path, std::ios::binary);
  out << *bytes;
  out.close();
  if (!out) return broken(Errc::io, "R-SRF-1", "", path);
  return {};
}

}  // namespace tactus::sim
