// SPDX-License-Identifier: Apache-2.0
/// Stiffness records.
#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

Bytes stiffness_record(const Bytes& data) { return varint(3) + varint(data.size()) + data; }

/// Nothing rigid; a deformable object of one vertex and one of three; these extension records.
Bytes with(Bytes extensions) {
  RawHeader header;
  header.objects.clear();
  RawDeformable first, second;
  first.shape = one_vertex();
  first.name = "first";
  second.name = "second";
  header = with_deformables(std::move(header), {first, second});
  header.extensions = std::move(extensions);
  return header.bytes();
}

}  // namespace

void add_scene_stiffness(Catalogue& c) {
  c.section(section::kStiffness);
  const auto first = stiffness_record({0, 97}), second = stiffness_record({1, 0, 1, 255});
  c.valid("stiffness",
          "The stiffness of the second of two deformable objects: a vertex that does not move, the least and the largest.",
          with(second), {"R-STR-20"});
  c.valid("stiffness-of-both", "The stiffness of two deformable objects, the second first, an unknown record between them.",
          with(second + Bytes{5, 1, 0} + first), {"R-STR-16", "R-STR-20"});
  c.valid("stiffness-longer", "A stiffness record with more bytes than are known.", with(stiffness_record({0, 97, 98, 99})),
          {"R-STR-20"});

  const Rejection cut{"truncated", "R-STR-20"}, wrong{"invalid", "R-STR-20"};
  c.invalid("stiffness-empty", "A stiffness record without object.", cut, with(stiffness_record({})));
  c.invalid("stiffness-cut", "A level is missing.", cut, with(stiffness_record({1, 0, 1})));
  c.invalid("stiffness-of-nothing", "object is the number of deformable objects.", wrong, with(stiffness_record({2, 0, 1, 255})));
  c.invalid("stiffness-of-nothing-cut", "object is the number of deformable objects, and no level follows.", wrong,
            with(stiffness_record({2})));
  c.invalid("stiffness-twice", "Two stiffness records of one object.", wrong, with(first + first));
  c.invalid("stiffness-twice-then-cut", "Two stiffness records of one object, the second without levels.", wrong,
            with(first + stiffness_record({0})));
  c.invalid("stiffness-of-rigid", "A stiffness record in a scene without deformable objects.", wrong,
            changed_header([&](RawHeader& h) { h.extensions = first; }));
  c.invalid("stiffness-then-overlong-type", "A second record has an overlong type; the stiffness before it is cut.",
            {"truncated", "R-STR-20", "R-STR-16"}, with(stiffness_record({1, 0, 1}) + Bytes{0x85, 0x00, 0x00}));
}

}  // namespace tactus::conformance
