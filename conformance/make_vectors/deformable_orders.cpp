// SPDX-License-Identifier: Apache-2.0
/// Two faults of a deformable object's declaration or packet at once: the one that is read first counts.
#include <utility>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"

namespace tactus::conformance {
namespace {

Bytes declared(const RawDeformable& item) { return only(item).bytes(); }

void add_declaration(Catalogue& c) {
  c.invalid("layered-before-rings", "rings is 33, layered 2.", {"malformed", "R-DEF-3", "R-DEF-3"},
            declared({.rings = 33, .layered = 2}));
  c.invalid("rings-before-vertices", "rings is 33, vertex_count 0.", {"invalid", "R-DEF-3", "R-DEF-4"},
            declared({.rings = 33, .vertex_count = Bytes{0}}));
  c.invalid("corner-before-cut", "The first triangle's corners are equal; the second is missing.",
            {"invalid", "R-DEF-6", "R-STR-5"},
            declared({.shape = {one_triangle().rest, {{0, 1, 1}}}, .triangle_count = Bytes{2}, .mode_count = Bytes(8, 0)}));
  c.invalid("rest-before-name", "A name with a line feed, and a rest position beyond 32 bits.",
            {"invalid", "R-DEF-5", "R-STR-11"}, [] {
              RawDeformable item{.shape = one_vertex(), .name = "a\nb"};
              const Bytes good = item.bytes();
              RawHeader raw;
              raw.objects.clear();
              raw.flags = 1;
              raw.deformables = Bytes{1} + without_last(good, 4) + varint(std::uint64_t{1} << 33) + Bytes{0, 0, 0};
              return raw.bytes();
            }());
  c.invalid("layered-before-cut", "layered is 2, and the body ends after it.", {"malformed", "R-DEF-3", "R-STR-5"},
            around({1, 1, 1, 'm', 2, 0, 1, 0, 0, 2}));
  c.invalid("models-kept-before-cut", "models_kept is 2, and the body ends after it.", {"malformed", "R-DEF-3", "R-STR-5"},
            around({1, 0, 1, 'm', 2, 8, 2}));
  c.invalid("cut-before-rings", "rings is 33; the body ends before vertex_count.", {"truncated", "R-STR-5", "R-DEF-3"},
            around({1, 1, 1, 'm', 33, 0, 1, 0, 0, 0, 0, 0, 1}));
  c.invalid("cut-before-triangle-count", "rings is 33; the body ends before triangle_count.", {"truncated", "R-STR-5", "R-DEF-3"},
            around({1, 1, 1, 'm', 33, 0, 1, 0, 0, 0, 0, 0, 1, 3}));
  c.invalid("room-before-rest", "A byte is missing for 3 vertices and 1 triangle; the first rest position is beyond 32 bits.",
            {"truncated", "R-STR-5", "R-DEF-5"}, counted(3, 1, zigzag_varint(std::int64_t{1} << 31) + Bytes(6, 0)));
  c.invalid("cut-before-corner", "A corner is the number 9 of 3 vertices; the body ends inside the triangle's last corner.",
            {"truncated", "R-STR-5", "R-DEF-6"}, counted(3, 1, Bytes(9, 0) + Bytes{18, 2, 0x82}));
  c.invalid("mode-count-before-room", "65 modes; none follows.", {"invalid", "R-DEF-7", "R-STR-5"},
            counted(1, 0, Bytes{0, 0, 0, 1, 65}));
}

void add_names(Catalogue& c) {
  RawDeformable item = with_modes({.shape = one_vertex(), .name = "a\nb"}, 1, 730);
  item.entries.back() = 2048;
  c.invalid("entry-before-name", "A name with a line feed, and an entry of 2048.", {"invalid", "R-DEF-7", "R-STR-11"},
            only(item).bytes());
  c.invalid("name-before-next-object", "A name with a line feed; the next object has profile 2.",
            {"invalid", "R-STR-11", "R-DEF-2"}, around(Bytes{2} + RawDeformable{.name = "a\nb"}.bytes() + Bytes{2}));
  RawHeader large;
  large.objects.clear();
  large.baseline_span = 64;
  std::vector<RawDeformable> items(227, {.shape = one_vertex(), .profile = 0, .quant_bits = 12, .models_kept = 1});
  c.invalid("names-before-states", "227 objects of one name, whose states take more than 2^28 bytes.",
            {"invalid", "R-STR-11", "R-STR-18"}, with_deformables(large, items).bytes());
}

/// A magnitude of 33 bits.
void too_wide(RangeEncoder& coder, MagnitudeModel& model) {
  coder.tree<4>(model, 15);
  coder.raw(5, 18);
}

/// Triangle 0 of a sheet is touched, then a packet of a triangle and a level that both are none.
Bytes triangle_and_level() {
  DeformableStream stream(only({.shape = {sheet(2, 2).rest, {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}}}}));
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

/// Packets 0 and 1 of a sheet at ticks 10 and 30, then any packet.
Bytes main_mesh(const Bytes& packet, std::int64_t tick = 30) {
  DeformableStream stream(only({.shape = sheet(2, 2)}, 4));
  stream.add(MainStep{.at = {.tick = 10, .key = true}}).add(MainStep{.at = {.tick = 30}});
  return stream.add_packet(tick, packet).bytes();
}

void add_main(Catalogue& c) {
  c.invalid("triangle-before-haptic", "Triangle 3 of 3, and haptic 169.", {"invalid", "R-DEF-9", "R-DEF-10"},
            triangle_and_level());
  c.invalid("late-before-baseline-delta", "baseline_delta is 0, and late 2^31.", {"malformed", "R-RNG-4", "R-PKT-3"},
            main_mesh(coded_main_packet(2, [](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.key, 0);
              coder.magnitude(models.baseline, 0);
              coder.magnitude(models.late, 1u << 31);
              coder.raw(1, 0);
            })));
  c.invalid("tick-before-head", "A packet on an older baseline, at tick 11, after tick 30; then visual of 33 bits.",
            {"invalid", "R-DEF-8", "R-RNG-4"}, main_mesh(coded_main_packet(2, [](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.key, 0);
              coder.magnitude(models.baseline, 2);
              coder.signed_value(models.late, 0);
              coder.bit(models.touched[0], 0);
              coder.bit(models.same_visual, 0);
              too_wide(coder, models.visual);
            })));
  DeformableStream stream(only({.shape = sheet(2, 2)}, 4));
  stream.add(MainStep{.at = {.tick = 10, .key = true}}).add(MainStep{.at = {.tick = 30}});
  c.invalid("end-before-record-tick", "Bytes left over, and a record of another tick.", {"malformed", "R-RNG-2", "R-FIL-7"},
            main_mesh(stream.composer().packet(MainStep{.at = {.tick = 31}}) + Bytes(8, 1), 40));
}

/// Packets 0 and 1 of profile thesis at ticks 10 and 30, then any packet.
Bytes thesis_mesh(const Bytes& packet) {
  DeformableStream stream(only({.shape = sheet(2, 2), .profile = 0, .quant_bits = 4}, 4));
  stream.add(ThesisStep{.at = {.tick = 10, .key = true}, .vertices = {{0}}});
  stream.add(ThesisStep{.at = {.tick = 30}, .vertices = {{8}}});
  return stream.add_packet(30, packet).bytes();
}

/// Packet 2, of vertex 0, after one change.
template <class Change>
Bytes thesis(Change change) {
  RawThesis raw{.sequence = 2,
                .key = 0,
                .baseline_delta = std::uint8_t{1},
                .list = thesis_symbols({0}, 8),
                .errors = thesis_symbols({3, 4, 5}, 4)};
  change(raw);
  return thesis_mesh(raw.bytes());
}

void add_thesis(Catalogue& c) {
  c.invalid("thesis-count-before-baseline", "baseline_delta is 5 of 4, and count 0.", {"invalid", "R-DEF-12", "R-PKT-3"},
            after_one_thesis_packet(4, {.baseline_delta = std::uint8_t{5}, .count = {0}}));
  c.invalid("thesis-list-before-errors", "The list ends with a 0, and the errors have bytes left over.",
            {"malformed", "R-RNG-3", "R-RNG-2"},
            after_one_thesis_packet(
                1, {.list = thesis_symbols({3}, 8) + Bytes{0}, .errors = thesis_symbols({1, 2, 3}, 4) + Bytes(6, 1)}));
  c.invalid("thesis-cut-before-tick-delta", "tick_delta is 2^32; the packet ends before range.",
            {"truncated", "R-DEF-11", "R-DEF-12"},
            thesis_mesh(Bytes{2, 0, 0, 1} + varint(std::uint64_t{1} << 32) + Bytes{1, 0, 0}));
  c.invalid("thesis-list-before-baseline", "baseline_delta is 5 of 4, and the list is cut.", {"truncated", "R-DEF-11", "R-PKT-3"},
            thesis([](RawThesis& r) {
              r.baseline_delta = std::uint8_t{5};
              r.list_bytes = varint(1000);
            }));
  c.invalid("thesis-tick-before-gap", "A packet at tick 2^32 - 1, and a gap of 9 of 9 vertices.",
            {"invalid", "R-DEF-8", "R-DEF-13"}, thesis([](RawThesis& r) {
              r.tick_delta = varint(0xffffffffu - 30);
              r.list = thesis_symbols({9}, 8);
            }));
  c.invalid("thesis-gap-before-list-end", "A gap of 9 of 9 vertices, and the list's last byte is 0.",
            {"invalid", "R-DEF-13", "R-RNG-3"}, thesis([](RawThesis& r) { r.list = thesis_symbols({9}, 8) + Bytes{0}; }));
}

}  // namespace

void add_deformable_orders(Catalogue& c) {
  add_declaration(c);
  add_names(c);
  add_main(c);
  add_thesis(c);
}

}  // namespace tactus::conformance
