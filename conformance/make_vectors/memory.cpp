// SPDX-License-Identifier: Apache-2.0
/// Headers that ask for more than they pay for: spec/20-stream.md section 5.
#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/mesh_build.h"

namespace tactus::conformance {
namespace {

/// Meshes of one vertex whose states hold the largest models: 1183992 bytes each.
Bytes with_models(int meshes) {
  RawHeader header;
  header.objects.clear();
  header.baseline_span = 64;
  std::vector<RawMesh> list;
  list.reserve(static_cast<std::size_t>(meshes));
  for (int i = 0; i < meshes; ++i)
    list.push_back({.shape = one_vertex(), .profile = 0, .name = std::to_string(i), .quant_bits = 12, .models_kept = 1});
  return with_meshes(header, list).bytes();
}

/// A triangle, then a mesh that announces so many vertices and triangles.
Bytes after_a_triangle(std::uint64_t vertices, std::uint64_t triangles) {
  RawMesh large{.name = "large"};
  large.vertex_count = varint(vertices);
  large.triangle_count = varint(triangles);
  RawHeader header;
  header.objects.clear();
  return with_meshes(header, {{}, large}).bytes();
}

}  // namespace

void add_memory(Catalogue& c) {
  const Rejection limit{"limit_exceeded", "R-STR-14"};
  c.invalid("vertices-of-all-meshes", "2^20 vertices after a mesh of three: three more than the limit.", limit,
            after_a_triangle(1 << 20, 0));
  c.invalid("triangles-of-all-meshes", "2^21 triangles after a mesh of one: one more than the limit.", limit,
            after_a_triangle(3, 1 << 21));
  c.invalid("state-bytes", "227 meshes of one vertex, whose states take 268766184 bytes: more than 2^28.",
            {"limit_exceeded", "R-STR-18"}, with_models(227));
}

}  // namespace tactus::conformance
