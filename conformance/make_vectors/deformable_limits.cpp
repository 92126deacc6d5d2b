// SPDX-License-Identifier: Apache-2.0
/// Declarations that ask for more than they pay for.
#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"

namespace tactus::conformance {
namespace {

/// Objects of one vertex whose states hold the largest models: 1183992 bytes each.
Bytes with_models(int count) {
  RawHeader header;
  header.objects.clear();
  header.baseline_span = 64;
  std::vector<RawDeformable> list;
  list.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    list.push_back({.shape = one_vertex(), .profile = 0, .name = std::to_string(i), .quant_bits = 12, .models_kept = 1});
  return with_deformables(header, list).bytes();
}

/// A triangle, then an object that announces so many vertices and triangles.
Bytes after_a_triangle(std::uint64_t vertices, std::uint64_t triangles) {
  RawDeformable large{.name = "large"};
  large.vertex_count = varint(vertices);
  large.triangle_count = varint(triangles);
  RawHeader header;
  header.objects.clear();
  return with_deformables(header, {{}, large}).bytes();
}

}  // namespace

void add_deformable_limits(Catalogue& c) {
  const Rejection limit{"limit_exceeded", "R-STR-14"};
  c.invalid("vertices-of-all-objects", "2^20 vertices after an object of three: three more than the limit.", limit,
            after_a_triangle(1 << 20, 0));
  c.invalid("triangles-of-all-objects", "2^21 triangles after an object of one: one more than the limit.", limit,
            after_a_triangle(3, 1 << 21));
  c.invalid("state-bytes", "227 objects of one vertex, whose states take 268766184 bytes: more than 2^28.",
            {"limit_exceeded", "R-STR-18"}, with_models(227));
}

}  // namespace tactus::conformance
