// SPDX-License-Identifier: Apache-2.0
/// Bounds records.
#include <bit>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

Bytes f64(double value) {
  Bytes out;
  ByteWriter(out).u64(std::bit_cast<std::uint64_t>(value));
  return out;
}

Bytes f64s(std::initializer_list<double> values) {
  Bytes out;
  for (const double value : values) out = out + f64(value);
  return out;
}

Bytes bounds_record(const Bytes& data) { return varint(2) + varint(data.size()) + data; }

/// heartbeat, visual_position, visual_rotation
Bytes visual() { return f64s({1, 0.006, 0.03125}); }

/// A header of one moving object and these extension records.
Bytes with(Bytes extensions) {
  RawHeader header;
  header.extensions = std::move(extensions);
  return header.bytes();
}

Bytes of_rule(std::uint8_t haptic, const Bytes& rest) { return with(bounds_record(visual() + Bytes{haptic} + rest)); }

/// A static object and two deformable ones.
RawHeader deformables() {
  RawHeader header;
  header.objects = {{"wall", Dof::none}};
  RawDeformable first, second;
  first.name = "first";
  second.name = "second";
  return with_deformables(std::move(header), {first, second});
}

}  // namespace

void add_scene_bounds(Catalogue& c) {
  c.section(section::kBounds);
  c.valid("bounds-off", "Bounds without a rule for forces.", of_rule(0, {}), {"R-STR-17"});
  c.valid("bounds-isotropic", "Bounds of an isotropic force error.", of_rule(1, f64s({0.08, 0.05})), {"R-STR-17"});
  c.valid("bounds-cone", "Bounds of a cone; zero, the smallest and the largest number.",
          of_rule(2, f64s({0, 0x1p-1074, 0x1.fffffffffffffp+1023})), {"R-STR-17"});
  c.valid("bounds-fixed", "Bounds fixed in contact.", of_rule(3, f64s({0.0015, 0.03125})), {"R-STR-17"});
  c.valid("bounds-perceptual", "Bounds by the curve of what is noticed.", of_rule(4, f64s({0.5, 0.05})), {"R-STR-17"});
  c.valid("bounds-longer", "A bounds record with more elements than are known, and an unknown record after it.",
          with(bounds_record(visual() + Bytes{0, 1, 2, 3}) + Bytes{5, 1, 0}), {"R-STR-16", "R-STR-17"});
  RawHeader of_deformables = deformables();
  of_deformables.extensions = bounds_record(Bytes{3} + f64s({0.00025, 0.025, 0.0002}) + Bytes{0} + f64(0));
  c.valid("bounds-deformables",
          "Bounds of two deformable objects, one of them without a haptic bound and not kept; nothing rigid moves.",
          of_deformables.bytes(), {"R-STR-17"});
  RawHeader promised = deformables();
  promised.extensions = bounds_record(Bytes{1} + f64(0.00025) + Bytes{2} + f64s({0, 0.025, 0.0002}));
  c.valid("bounds-promises", "Bounds of two deformable objects, one kept without a haptic bound, one not kept with it.",
          promised.bytes(), {"R-STR-17"});
  RawHeader still;
  still.objects.clear();
  still.extensions = bounds_record({});
  c.valid("bounds-of-nothing", "A bounds record in a scene where nothing moves: no element, present all the same.", still.bytes(),
          {"R-STR-17"});

  const Rejection cut{"truncated", "R-STR-17"}, wrong{"invalid", "R-STR-17"};
  c.invalid("bounds-without-haptic", "A bounds record ends before haptic.", cut, with(bounds_record(visual())));
  c.invalid("bounds-cut-number", "The last number of a bounds record has seven bytes.", cut,
            with(bounds_record(without_last(visual() + Bytes{1} + f64s({0.08, 0.05}), 1))));
  c.invalid("bounds-haptic-5", "haptic is 5.", wrong, of_rule(5, f64s({0.08, 0.05})));
  c.invalid("bounds-perceptual-cut", "A bounds record with haptic 4 ends after perceptual_share.", cut, of_rule(4, f64(0.5)));
  c.invalid("bounds-perceptual-negative", "perceptual_share has its sign bit set.", wrong, of_rule(4, f64s({-0.5, 0.05})));
  c.invalid("bounds-promise-4", "promise is 4.", wrong, [] {
    RawHeader header = deformables();
    header.extensions = bounds_record(Bytes{4} + f64(0) + Bytes{0} + f64(0));
    return header.bytes();
  }());
  c.invalid("bounds-negative", "A bound has its sign bit set: -0.", wrong, of_rule(1, f64s({-0.0, 0.05})));
  c.invalid("bounds-infinite", "A bound is infinite.", wrong, of_rule(1, f64(0.08) + Bytes{0, 0, 0, 0, 0, 0, 0xf0, 0x7f}));
  c.invalid("bounds-negative-then-cut", "A bound is negative, and the record ends after it.", {"invalid", "R-STR-17", "R-STR-17"},
            with(bounds_record(f64(-1))));
  c.invalid("bounds-twice", "Two bounds records.", wrong,
            with(bounds_record(visual() + Bytes{0}) + bounds_record(visual() + Bytes{0})));
  c.invalid("bounds-then-overlong-type", "A second record has an overlong type; the bounds before it are wrong.",
            {"invalid", "R-STR-17", "R-STR-16"}, with(bounds_record(visual() + Bytes{9}) + Bytes{0x85, 0x00, 0x00}));
}

}  // namespace tactus::conformance
