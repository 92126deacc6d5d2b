// SPDX-License-Identifier: Apache-2.0
/// Declarations that ask for more than they pay for.
#include <utility>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

/// Objects of one vertex whose states hold the largest models: 1183992 bytes each.
Bytes with_models(int count) {
  RawHeader header;
  header.objects.clear();
  header.baseline_span = 64;
  return with_deformables(header, with_large_states(count)).bytes();
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

constexpr std::size_t kObjectsAt = 25;  // where a declaration has its rigid objects, with an object_count of two bytes

/// A declaration of so many rigid objects of one name, and then these bytes about deformable ones.
Input after_objects(std::size_t objects, Bytes deformables) {
  RawHeader header;
  header.objects.assign(objects, {.name = "a"});
  header.flags = 1;
  header.deformables = std::move(deformables);
  Bytes all = header.bytes();
  const Bytes object(all.begin() + kObjectsAt, all.begin() + kObjectsAt + 32);
  return {std::move(all), {kObjectsAt, object, objects - 1}};
}

/// Deformable objects of every kind, whose states take 2^28 bytes if the smallest has one bit; one of 338686 vertices in one place.
Input largest_states(std::uint8_t quant_bits) {
  RawHeader header;
  header.baseline_span = 64;
  RawDeformable basis{.name = "basis", .layered = 1, .fade = 1, .mode_steps = std::vector<std::uint16_t>(12, 1)};
  basis.entries.assign(std::size_t{12} * 9, 0);
  const Shape large{std::vector<Vec3i>(338686), {}};
  header = with_deformables(header, {basis,
                                     {.name = "plain"},
                                     {.shape = one_vertex(), .profile = 0, .name = "kept", .models_kept = 1},
                                     {.shape = one_vertex(), .profile = 0, .name = "small", .quant_bits = quant_bits},
                                     {.shape = large, .profile = 0, .name = "large", .quant_bits = 1}});
  Bytes all = header.bytes();
  const std::size_t zeros = 3 * large.rest.size(), begin = all.size() - 4 - zeros;
  return {std::move(all), {begin, {0}, zeros}};
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
  c.invalid("states-over-limit", "States of 2^28 + 16 bytes.", {"limit_exceeded", "R-STR-18"}, largest_states(2));
  c.section(section::kLimits);
  c.valid("states-at-limit", "States of 2^28 bytes, as many as a decoder must take.", largest_states(1), {"R-STR-18"});
  c.invalid("4096-objects-of-both-kinds", "3841 rigid objects and 255 deformable ones, none of which follows.",
            {"truncated", "R-STR-5"}, after_objects(3841, varint(255)));
  c.invalid("4097-objects-of-both-kinds", "3842 rigid objects and 255 deformable ones, the first of which has profile 2.",
            {"limit_exceeded", "R-STR-14", "R-DEF-2"}, after_objects(3842, varint(255) + Bytes{2}));
  c.invalid("count-before-limit", "3841 rigid objects and 256 deformable ones.", {"invalid", "R-DEF-1", "R-STR-14"},
            after_objects(3841, varint(256)));
}

}  // namespace tactus::conformance
