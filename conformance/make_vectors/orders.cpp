// SPDX-License-Identifier: Apache-2.0
/// Two faults at once: the one that is read first counts. And edges that a decoder could get wrong unseen.
#include <limits>
#include <utility>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/mesh_build.h"

namespace tactus::conformance {
namespace {

Bytes crc_flipped(Bytes record) { return with_last_bit_flipped(std::move(record)); }

void add_frame(Catalogue& c) {
  c.invalid("wrong-first-byte", "The first byte is not the magic's.", {"malformed", "R-STR-1"},
            changed_header([](RawHeader& h) { h.magic[0] = 0x88; }));
  c.invalid("profile-1", "profile is 1: reserved.", {"unsupported", "R-STR-3"},
            changed_header([](RawHeader& h) { h.profile = 1; }));
  c.invalid("flags-4", "The third flag is set.", {"malformed", "R-STR-4"}, changed_header([](RawHeader& h) { h.flags = 4; }));
  c.invalid("cut-before-version", "Eleven bytes, of version 2.", {"truncated", "R-STR-5"},
            first(changed_header([](RawHeader& h) { h.version = 2; }), 11));
  c.invalid("version-before-profile", "version and profile are 2.", {"unsupported", "R-STR-2"},
            changed_header([](RawHeader& h) { h.version = h.profile = 2; }));
  c.invalid("profile-before-flags", "profile is 2, flags are 4.", {"malformed", "R-STR-3"}, changed_header([](RawHeader& h) {
              h.profile = 2;
              h.flags = 4;
            }));
  c.invalid("flags-before-size", "flags are 4, and the body is too large.", {"malformed", "R-STR-4"},
            first(changed_header([](RawHeader& h) { h.flags = 4; }), 8) + Bytes{0x01, 0x00, 0x10, 0x00});
}

void add_body(Catalogue& c) {
  c.invalid("rate-before-grid", "tick_rate is 0, position_exp 31.", {"invalid", "R-STR-6"}, changed_header([](RawHeader& h) {
              h.tick_rate = 0;
              h.grid.position = 31;
            }));
  c.invalid("grid-before-extrapolation", "position_exp is 31, max_extrapolation 0.", {"invalid", "R-STR-7"},
            changed_header([](RawHeader& h) {
              h.grid.position = 31;
              h.max_extrapolation = 0;
            }));
  c.invalid("rate-before-count", "tick_rate is 0, object_count 4097.", {"invalid", "R-STR-6"}, changed_header([](RawHeader& h) {
              h.tick_rate = 0;
              h.object_count = varint(4097);
            }));
  c.invalid("name-before-dof", "A name with a line feed, and dof 64.", {"invalid", "R-STR-11"}, changed_header([](RawHeader& h) {
              h.objects[0] = {"a\nb", 64};
            }));
  c.invalid("dof-before-rotation", "dof 64, and a rotation of length 0.", {"invalid", "R-STR-12"},
            changed_header([](RawHeader& h) {
              h.objects[0] = {"a", 64, {}, {}};
            }));
  RawHeader cut;
  cut.objects[0].name = "a name\nof more";
  c.invalid("cut-before-name", "A name with a line feed; the body ends inside the rotation.", {"truncated", "R-STR-5"},
            cut.around(without_last(cut.body(), 8)));
  c.invalid("extension-before-equal-names", "Two objects of one name, then an extension without a size.",
            {"malformed", "R-STR-16"}, changed_header([](RawHeader& h) {
              h.objects.push_back(h.objects[0]);
              h.extensions = {5};
            }));
  c.invalid("dof-before-equal-names", "Two objects of one name; the second one's dof is 64.", {"invalid", "R-STR-12"},
            changed_header([](RawHeader& h) {
              h.objects.push_back(h.objects[0]);
              h.objects[1].dof = 64;
            }));
  for (const char last : {'\x1f', '\0'}) {
    c.invalid(last == 0 ? "name-with-0" : "name-with-31", "A name with a code point below 32.", {"invalid", "R-STR-11"},
              changed_header([&](RawHeader& h) { h.objects[0].name = std::string("ab") + last; }));
  }
  c.invalid("extension-of-2-64", "An extension record announces 2^64 - 1 bytes.", {"malformed", "R-STR-16"},
            changed_header([](RawHeader& h) { h.extensions = Bytes{5} + varint(~std::uint64_t{0}); }));
  c.valid("equal-exponents", "Grids of position and velocity, of rotation and spin are the same.",
          changed_header([](RawHeader& h) {
            h.grid = {20, 20, 12, 12};
          }),
          {"R-STR-7"});
  constexpr std::int32_t kUnit = 1 << 20;
  c.valid("shortest-rotation", "The squares of a rotation add to exactly 2^60 - 2^41.", changed_header([](RawHeader& h) {
            h.objects[0].rotation = {1023 * kUnit, -45 * kUnit, 4 * kUnit, 2 * kUnit};
          }),
          {"R-STR-13"});
  c.valid("longest-rotation", "The squares of a rotation add to exactly 2^60 + 2^41.", changed_header([](RawHeader& h) {
            h.objects[0].rotation = {kOne30, 0, kUnit, -kUnit};
          }),
          {"R-STR-13"});
}

void add_file(Catalogue& c) {
  Stream stream(RawHeader{});
  stream.add({.tick = 1, .key = true});
  const Bytes good = stream.bytes();
  const Rejection record_fault{"malformed", "R-FIL-6"};
  c.invalid("trailer-of-nine-bytes", "A trailer's payload is a byte long.", record_fault, good + record(3, Bytes(9, 0)));
  c.invalid("tick-delta-of-2-64", "A second record's tick_delta is 2^64 - 1.", record_fault,
            good + record(1, varint(~std::uint64_t{0}) + Bytes{1, 0}));
  c.invalid("size-before-type", "A record of unknown type 4 with an overlong size.", record_fault,
            good + Bytes{4, 0x81, 0x00, 0});
  c.invalid("crc-before-tick-delta", "An overlong tick_delta, and a wrong check value.", {"checksum", "R-FIL-5"},
            good + crc_flipped(record(1, Bytes{0x81, 0x00, 3, 0})));
  c.invalid("largest-record-cut", "A packet record announces 2^20 + 6 bytes, as many as there may be; none follows.",
            {"truncated", "R-FIL-2"}, good + Bytes{1} + varint((1u << 20) + 6));
}

/// Packets 100 and 101 at ticks 10 and 30, then one with any head.
Bytes rigid_head(const PacketHead& head, std::uint8_t span = 4) {
  RawHeader raw;
  raw.baseline_span = span;
  raw.objects = {{"a"}, {"b"}};
  Stream stream(raw);
  stream.add({.tick = 10, .key = true, .sequence = std::uint16_t{100}});
  stream.add({.tick = 30});
  return stream.add_packet(30, raw_packet(stream.header(), 102, head, {})).bytes();
}

/// Triangle 0 of a sheet is touched, then a packet of a triangle and a level that both are none.
Bytes triangle_and_level() {
  MeshStream stream(only({.shape = {sheet(2, 2).rest, {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}}}}));
  stream.add(MainStep{.at = {.tick = 10, .key = true}, .triangle = 0u, .haptic = 168});
  stream.add_packet(11, coded_main_packet(1, [](RangeEncoder& coder, MainModels& models) {
                      coder.bit(models.key, 0);
                      coder.signed_value(models.late, 0);
                      coder.bit(models.touched[1], 1);
                      coder.bit(models.same_triangle, 0);
                      coder.bit(models.near_triangle, 0);
                      coder.raw(2, 3);
                      coder.signed_value(models.haptic, 1);
                    }));
  return stream.bytes();
}

/// A haptic level that would fall below 0 stays there.
Bytes haptic_below_0() {
  MeshStream stream(only({.shape = one_triangle()}));
  stream.add(MainStep{.at = {.tick = 10, .key = true}, .triangle = 0u, .haptic = 5});
  stream.add_packet(11, coded_main_packet(1, [](RangeEncoder& coder, MainModels& models) {
                      coder.bit(models.key, 0);
                      coder.signed_value(models.late, 0);
                      coder.bit(models.touched[1], 1);
                      coder.bit(models.same_triangle, 1);
                      coder.signed_value(models.haptic, -std::numeric_limits<std::int32_t>::max());
                      coder.bit(models.same_visual, 1);
                      coder.tree<2>(models.density[1], 3);
                    }));
  return stream.bytes();
}

Bytes thesis(std::uint8_t span, RawThesis raw) {
  MeshStream stream(only({.shape = sheet(2, 2), .profile = 0, .quant_bits = 4}, span));
  stream.add(ThesisStep{.at = {.tick = 10, .key = true}, .vertices = {{0}}});
  raw.sequence = 1;
  raw.key = 0;
  return stream.add_packet(10, raw.bytes()).bytes();
}

/// Points of a lattice of 27 places, copies among them, and triangles between any three: where a unit is a step of the lattice, the
/// matrix of some vertices' parents is not definite.
Shape crowded(std::uint64_t seed, std::int32_t step) {
  Random random(seed);
  Shape shape;
  for (int i = 0; i < 60; ++i) {
    Vec3i place{};
    for (auto& x : place) x = (static_cast<std::int32_t>(random.below(3)) - 1) * step;
    shape.rest.push_back(place);
  }
  while (shape.triangles.size() < 150) {
    const Triangle t{random.below(60), random.below(60), random.below(60)};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) shape.triangles.push_back(t);
  }
  return shape;
}

Bytes crowded_stream(std::int32_t step) {
  MeshStream stream(only({.shape = crowded(77, step)}));
  Random random(78);
  for (int i = 0; i < 3; ++i)
    stream.add(MainStep{.at = {.tick = i, .key = i == 0}, .density = 3, .residuals = random_residuals(random, 9, 200)});
  return stream.finished();
}

Bytes mesh_of(const RawMesh& mesh) { return only(mesh).bytes(); }

}  // namespace

void add_stream_orders(Catalogue& c) {
  add_frame(c);
  add_body(c);
  add_file(c);
}

void add_rigid_orders(Catalogue& c) {
  c.invalid("count-before-baseline", "baseline_delta is 0, and count is wider than 32 bits.", {"malformed", "R-RNG-4"}, [] {
    RawHeader raw;
    raw.baseline_span = 4;
    raw.objects = {{"a"}, {"b"}};
    Stream stream(raw);
    stream.add({.tick = 10, .key = true});
    stream.add_packet(10, coded_packet(1, [](RangeEncoder& coder, RigidModels& models) {
                        coder.bit(models.key, 0);
                        coder.magnitude(models.baseline, 0);
                        coder.magnitude(models.tick_delta, 0);
                        coder.tree<4>(models.count, 15);
                        coder.raw(5, 18);
                      }));
    return stream.bytes();
  }());
  c.invalid("baseline-before-count-0", "baseline_delta and count are 0.", {"invalid", "R-PKT-3"}, rigid_head({false, 0, 0, 0}));
  c.invalid("tick-before-count-0", "A tick in the past, and count 0.", {"invalid", "R-RIG-1"}, rigid_head({false, 2, 0, 0}));
  c.invalid("baseline-before-tick", "The baseline was never there, and the tick runs over.", {"state", "R-PKT-4"},
            rigid_head({false, 3, 0xffffffffu, 1}));
}

void add_mesh_orders(Catalogue& c) {
  c.invalid("split-before-rings", "rings is 33, split 2.", {"malformed", "R-MES-3"}, mesh_of({.rings = 33, .split = 2}));
  c.invalid("rings-before-vertices", "rings is 33, vertex_count 0.", {"invalid", "R-MES-3"},
            mesh_of({.rings = 33, .vertex_count = Bytes{0}}));
  c.invalid("corner-before-cut", "The first triangle's corners are equal; the second is missing.", {"invalid", "R-MES-6"},
            mesh_of({.shape = {one_triangle().rest, {{0, 1, 1}}}, .triangle_count = Bytes{2}, .mode_count = Bytes(8, 0)}));
  c.invalid("first-two-corners-equal", "The first and the second corner are equal.", {"invalid", "R-MES-6"},
            mesh_of({.shape = {one_triangle().rest, {{1, 1, 2}}}}));
  c.invalid("rest-before-name", "A name with a line feed, and a rest position beyond 32 bits.", {"invalid", "R-MES-5"}, [] {
    RawMesh mesh{.shape = one_vertex(), .name = "a\nb"};
    const Bytes good = mesh.bytes();
    RawHeader raw;
    raw.objects.clear();
    raw.flags = 1;
    raw.meshes = Bytes{1} + without_last(good, 4) + varint(std::uint64_t{1} << 33) + Bytes{0, 0, 0};
    return raw.bytes();
  }());
  c.invalid("triangle-before-level", "Triangle 3 of 3, and haptic 169.", {"invalid", "R-MES-9"}, triangle_and_level());
  c.invalid("thesis-count-before-baseline", "baseline_delta is 5 of 4, and count 0.", {"invalid", "R-MES-12"},
            thesis(4, {.baseline_delta = std::uint8_t{5}, .count = {0}}));
  c.invalid("thesis-list-before-errors", "The list ends with a 0, and the errors have bytes left over.", {"malformed", "R-RNG-3"},
            thesis(1, {.list = thesis_symbols({3}, 8) + Bytes{0}, .errors = thesis_symbols({1, 2, 3}, 4) + Bytes(6, 1)}));
  c.invalid("thesis-lowest-negative", "lowest is -(2^28 + 1).", {"invalid", "R-MES-12"},
            thesis(1, {.lowest = zigzag_varint(-(1 << 28) - 1), .list = thesis_symbols({0}, 8)}));
  c.valid("haptic-below-0", "haptic_change leads far below 0: haptic is 0.", haptic_below_0(), {"R-MES-10"});
  c.valid("crowded", "Copies and near neighbours among parents, on a mesh of two units: some matrices are not definite.",
          crowded_stream(1));
  c.valid("crowded-wide", "The same mesh a thousand times as wide.", crowded_stream(1000));
  c.valid("255-meshes", "As many meshes as parts have numbers.", [] {
    RawHeader raw;
    raw.objects.clear();
    std::vector<RawMesh> meshes;
    meshes.reserve(255);
    for (int i = 0; i < 255; ++i) meshes.push_back({.shape = one_vertex(), .name = std::to_string(i)});
    return with_meshes(raw, meshes).bytes();
  }());
}

}  // namespace tactus::conformance
