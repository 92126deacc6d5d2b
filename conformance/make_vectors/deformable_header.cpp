// SPDX-License-Identifier: Apache-2.0
/// Deformable objects in the scene declaration.
#include <utility>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr std::int64_t kTwo31 = std::int64_t{1} << 31;

/// The header of one deformable object, main or thesis, after one change.
template <class Change>
Bytes changed(std::uint8_t profile, Change change) {
  RawDeformable item{.shape = sheet(2, 2), .profile = profile};
  if (profile == 1) item = with_modes(std::move(item), 2, 670);
  change(item);
  return only(item).bytes();
}

Bytes zeros(std::size_t count) { return Bytes(count, 0); }

void add_valid(Catalogue& c) {
  c.section(section::kDeformable);
  c.valid("lower-limits", "Thesis, main: every field at its lower limit.",
          with_deformables({}, {{.shape = one_vertex(), .profile = 0, .name = "a", .rings = 0, .quant_bits = 1},
                                {.shape = one_vertex(), .name = "b", .rings = 0, .frame_period = 1}})
              .bytes(),
          {"R-DEF-1", "R-DEF-3", "R-DEF-4"});
  RawDeformable high{.shape = one_triangle(),
                     .name = "\xc3\xa9lan",
                     .rings = 32,
                     .frame_period = 1 << 28,
                     .layered = 1,
                     .fade = 65535,
                     .weight_sets = 7,
                     .mode_steps = {1, 65535}};
  for (int i = 0; i < 18; ++i) high.entries.push_back(i % 2 == 0 ? 2047 : -2047);
  high.shape.rest = {{-kTwo31, kTwo31 - 1, 0}, {kTwo31 - 1, -kTwo31, 0}, {-kTwo31, kTwo31 - 1, 1}};
  c.valid("upper-limits", "Thesis, main: every field at its upper limit, rest positions at both ends of 32 bits.",
          with_deformables({}, {{.profile = 0, .rings = 32, .quant_bits = 12, .models_kept = 1}, high}).bytes(),
          {"R-DEF-3", "R-DEF-5", "R-DEF-7"});
  c.valid("255-objects", "As many deformable objects as substreams have numbers.",
          [] {
            RawHeader raw;
            raw.objects.clear();
            std::vector<RawDeformable> items;
            items.reserve(255);
            for (int i = 0; i < 255; ++i) items.push_back({.shape = one_vertex(), .name = std::to_string(i)});
            return with_deformables(raw, items).bytes();
          }(),
          {"R-DEF-1"});
}

void add_counts(Catalogue& c) {
  const Rejection cut{"truncated", "R-STR-5"}, overlong{"malformed", "R-STR-5"};
  c.invalid("flag-64", "The seventh flag is set.", {"malformed", "R-STR-4"}, [] {
    RawHeader header = only({});
    header.flags = 64;
    return header.bytes();
  }());
  c.invalid("no-deformable-count", "The flag is set and the body ends.", cut, around({}));
  c.invalid("overlong-deformable-count", "deformable_count 1 is written in two bytes.", overlong, around({0x81, 0x00}));
  c.invalid("deformable-count-0", "The flag is set and deformable_count is 0.", {"malformed", "R-DEF-1"}, around({0}));
  c.invalid("deformable-count-256", "One deformable object more than substreams have numbers; none follows.",
            {"invalid", "R-DEF-1"}, around(varint(256)));
  c.invalid("second-object-missing", "deformable_count is 2; one follows.", cut, around(varint(2) + RawDeformable{}.bytes()));
  c.invalid("cut-parameters", "The body ends inside frame_period.", cut, around({1, 1, 1, 'm', 2, 0, 1}));
  c.invalid("cut-before-layered", "The body ends before layered.", cut, around({1, 1, 1, 'm', 2, 0, 1, 0, 0}));
  c.invalid("overlong-vertex-count", "vertex_count 3 is written in two bytes.", overlong, changed(1, [](RawDeformable& m) {
              m.vertex_count = Bytes{0x83, 0x00};
            }));
  c.invalid("no-room", "One byte too few for 3 vertices and 1 triangle.", cut, counted(3, 1, zeros(11)));
  c.invalid("no-room-for-2-20", "2^20 vertices announced; none follows.", cut, counted(1 << 20, 0, zeros(3)));
  c.invalid("no-room-for-2-21", "2^21 triangles announced; none follows.", cut, counted(3, 1 << 21, zeros(9)));
  c.invalid("no-room-for-modes", "One byte too few for a mode of one vertex.", cut,
            counted(1, 0, zeros(3) + Bytes{1, 1} + zeros(4)));
  c.invalid("cut-corner", "The body ends inside the last corner.", cut, counted(3, 1, zeros(9) + Bytes{0, 2, 0x82}));
  c.invalid("overlong-rest", "A rest coordinate's difference 0 is written in two bytes.", overlong,
            counted(1, 0, Bytes{0x80, 0x00} + zeros(3)));
  c.invalid("overlong-then-cut", "vertex_count is overlong, then the body ends.", {"malformed", "R-STR-5", "R-STR-5"},
            around({1, 1, 1, 'm', 2, 0, 1, 0, 0, 0, 0, 0, 1, 0x83, 0x00}));
}

void add_rules(Catalogue& c) {
  const Rejection parameter{"invalid", "R-DEF-3"}, count{"invalid", "R-DEF-4"}, range{"invalid", "R-DEF-5"},
      corner{"invalid", "R-DEF-6"}, basis{"invalid", "R-DEF-7"};
  c.invalid("object-profile-2", "A deformable object's profile is 2.", {"unsupported", "R-DEF-2"}, around({1, 2}));
  c.invalid("rings-33", "rings is 33.", parameter, changed(1, [](RawDeformable& m) { m.rings = 33; }));
  c.invalid("quant-bits-0", "quant_bits is 0.", parameter, changed(0, [](RawDeformable& m) { m.quant_bits = 0; }));
  c.invalid("quant-bits-13", "quant_bits is 13.", parameter, changed(0, [](RawDeformable& m) { m.quant_bits = 13; }));
  c.invalid("models-kept-2", "models_kept is 2.", {"malformed", "R-DEF-3"},
            changed(0, [](RawDeformable& m) { m.models_kept = 2; }));
  c.invalid("frame-period-0", "frame_period is 0.", parameter, changed(1, [](RawDeformable& m) { m.frame_period = 0; }));
  c.invalid("frame-period-too-long", "frame_period is 2^28 + 1.", parameter,
            changed(1, [](RawDeformable& m) { m.frame_period = (1 << 28) + 1; }));
  c.invalid("layered-2", "layered is 2.", {"malformed", "R-DEF-3"}, changed(1, [](RawDeformable& m) { m.layered = 2; }));
  c.invalid("no-vertices", "vertex_count is 0.", count, counted(0, 0, zeros(1)));
  c.invalid("too-many-vertices", "vertex_count is 2^20 + 1.", count, counted((1 << 20) + 1, 0, zeros(1)));
  c.invalid("too-many-triangles", "triangle_count is 2^21 + 1.", count, counted(3, (1 << 21) + 1, zeros(9)));
  c.invalid("rest-beyond-32-bits", "The second vertex is one unit beyond 2^31 - 1.", range,
            counted(2, 0, zigzag_varint(kTwo31 - 1) + zeros(2) + Bytes{2, 0, 0, 0}));
  c.invalid("rest-below-32-bits", "A rest coordinate is one unit below -2^31.", range,
            counted(1, 0, zigzag_varint(-kTwo31 - 1) + zeros(3)));
  c.invalid("rest-of-64-bits", "A rest coordinate's difference has 64 bits.", range,
            counted(1, 0, varint(~std::uint64_t{0}) + zeros(3)));
  c.invalid("rest-before-cut", "x is beyond 32 bits, and the body ends inside y.", {"invalid", "R-DEF-5", "R-STR-5"},
            counted(1, 0, zigzag_varint(kTwo31) + Bytes{0x80}));
  c.invalid("corner-of-no-vertex", "A corner is the number of vertices.", corner, counted(3, 1, zeros(9) + Bytes{0, 2, 4, 0}));
  c.invalid("negative-corner", "A corner is -1.", corner, counted(3, 1, zeros(9) + Bytes{1, 2, 2, 0}));
  c.invalid("equal-corners", "Two corners of a triangle are equal.", corner, counted(3, 1, zeros(9) + Bytes{0, 2, 0, 0}));
  c.invalid("first-two-corners-equal", "The first and the second corner are equal.", corner,
            only({.shape = {one_triangle().rest, {{1, 1, 2}}}}).bytes());
  c.invalid("first-and-last-corner-equal", "The first and the last corner are equal.", corner,
            counted(3, 1, zeros(9) + Bytes{0, 2, 1, 0}));
  c.invalid("corner-of-33-bits", "A corner's difference is 2^32: in 32-bit arithmetic it would be 0.", corner,
            counted(3, 1, zeros(9) + zigzag_varint(std::int64_t{1} << 32) + Bytes{2, 2, 0}));
  c.invalid("65-modes", "65 modes, each whole.", basis, changed(1, [](RawDeformable& m) { m = with_modes({}, 65, 671); }));
  c.invalid("mode-step-0", "A mode's step is 0.", basis, changed(1, [](RawDeformable& m) { m.mode_steps[1] = 0; }));
  c.invalid("entry-2048", "An entry of a mode is 2048.", basis, changed(1, [](RawDeformable& m) { m.entries.back() = 2048; }));
  c.invalid("entry-minus-2048", "An entry of a mode is -2048.", basis,
            changed(1, [](RawDeformable& m) { m.entries[0] = -2048; }));
  c.invalid("mode-step-before-cut", "A mode's step is 0, and its last entry is cut.", {"invalid", "R-DEF-7", "R-STR-5"},
            counted(1, 0, zeros(3) + Bytes{1, 1, 0, 0, 0, 0, 0x80}));
}

void add_names(Catalogue& c) {
  const Rejection name{"invalid", "R-STR-11"};
  c.invalid("without-name", "A deformable object's name is empty.", name, changed(0, [](RawDeformable& m) { m.name.clear(); }));
  c.invalid("control-in-name", "A deformable object's name holds a line feed.", name,
            changed(1, [](RawDeformable& m) { m.name = "a\nb"; }));
  c.invalid("name-of-rigid-object", "A deformable object has the name of a rigid one.", name,
            with_deformables({}, {{.shape = one_triangle(), .name = "cube"}}).bytes());
  c.invalid("equal-names", "Two deformable objects have the same name.", name,
            with_deformables({}, {{.shape = one_vertex()}, {.shape = one_triangle()}}).bytes());
  RawHeader extended = only({});
  extended.extensions = {1};
  c.invalid("extension-after-object", "The body ends inside an extension after a deformable object.", {"malformed", "R-STR-16"},
            extended.bytes());
}

}  // namespace

void add_deformable_header(Catalogue& c) {
  add_valid(c);
  add_counts(c);
  add_rules(c);
  add_names(c);
}

}  // namespace tactus::conformance
