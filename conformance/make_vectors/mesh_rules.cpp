// SPDX-License-Identifier: Apache-2.0
/// Every rule of mesh packets, broken once or more: spec/60-mesh.md sections 5 and 8. Each file begins with packets that are good.
#include <algorithm>
#include <limits>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/mesh_build.h"

namespace tactus::conformance {
namespace {

constexpr std::uint32_t kLastTick = 0xfffffffe;
Rejection wider() { return {"malformed", "R-RNG-4"}; }

RawMesh main_mesh() { return with_modes({.shape = {sheet(2, 2).rest, {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}}}}, 2, 680); }
RawMesh thesis_mesh() { return {.shape = sheet(2, 2), .profile = 0, .quant_bits = 4}; }

/// Packets 0 and 1 at ticks 10 and 30; triangle 0 is touched.
MeshStream two_packets(std::uint8_t span = 1) {
  MeshStream stream(only(main_mesh(), span));
  stream.add(MainStep{.at = {.tick = 10, .key = true}, .triangle = 0u, .haptic = 12});
  stream.add(MainStep{.at = {.tick = 30}, .triangle = 0u, .haptic = 12});
  return stream;
}

MeshStream two_thesis_packets(std::uint8_t span = 1) {
  MeshStream stream(only(thesis_mesh(), span));
  stream.add(ThesisStep{.at = {.tick = 10, .key = true}, .vertices = {{0}, {4, {1, 2, 3}}}});
  stream.add(ThesisStep{.at = {.tick = 30}, .vertices = {{8}}});
  return stream;
}

template <class Step>
Bytes then(MeshStream stream, const Step& step) {
  return stream.add(step).bytes();
}

Bytes then_packet(MeshStream stream, const Bytes& packet) { return stream.add_packet(30, packet).bytes(); }

/// The two packets, then one at tick 31 whose symbols after `late` are written by `code`.
template <class Code>
Bytes then_coded(Code code) {
  return then_packet(two_packets(), coded_main_packet(2, [&](RangeEncoder& coder, MainModels& models) {
                       coder.bit(models.key, 0);
                       coder.signed_value(models.late, 0);
                       code(coder, models);
                     }));
}

/// No touch, the same visual bound, density 1.
void quiet_head(RangeEncoder& coder, MainModels& models) {
  coder.bit(models.touched[1], 0);
  coder.bit(models.same_visual, 1);
  coder.tree<2>(models.density[1], 1);
}

/// A magnitude of 33 bits.
void too_wide(RangeEncoder& coder, MagnitudeModel& model) {
  coder.tree<4>(model, 15);
  coder.raw(5, 18);
}

void add_packet_rules(Catalogue& c) {
  const Rejection no_baseline{"state", "R-PKT-4"}, stale{"state", "R-PKT-5"}, tick{"invalid", "R-MES-8"};
  c.invalid("packet-of-0-bytes", "A packet without a byte.", {"truncated", "R-PKT-2"}, then_packet(two_packets(), {}));
  c.invalid("packet-of-1-byte", "A packet of half a sequence number.", {"truncated", "R-PKT-2"}, then_packet(two_packets(), {2}));
  c.invalid("baseline-delta-0", "baseline_delta is 0.", {"invalid", "R-PKT-3"},
            then(two_packets(4), MainStep{.at = {.tick = 31, .baseline = 0}}));
  c.invalid("baseline-delta-5", "baseline_delta is 5; baseline_span is 4.", {"invalid", "R-PKT-3"},
            then(two_packets(4), MainStep{.at = {.tick = 31, .baseline = 5}}));
  c.invalid("first-is-not-key", "The first packet builds on a packet before it.", no_baseline,
            MeshStream(only(main_mesh())).add(MainStep{.at = {.tick = 1}}).bytes());
  c.invalid("lost-baseline", "A packet is missing; the next one builds on it.", no_baseline,
            then(two_packets(), MainStep{.at = {.tick = 31, .sequence = std::uint16_t{3}}}));
  c.invalid("repeated-packet", "A packet with the sequence number of the one before.", stale,
            then(two_packets(), MainStep{.at = {.tick = 31, .key = true, .sequence = std::uint16_t{1}}}));
  c.valid("half-the-circle", "A key packet 32768 ahead begins anew.",
          then(two_packets(), MainStep{.at = {.tick = 31, .key = true, .sequence = std::uint16_t{32769}}}), {"R-PKT-5"});
  c.invalid("stale-before-all", "A stale packet whose payload breaks R-RNG-4: the sequence is checked first.", stale,
            then_packet(two_packets(), {1, 0, 0xff, 0xff, 0xff, 0xff}));
  c.invalid("tick-mismatch", "The record says tick 30, the packet 31.", {"invalid", "R-FIL-7"},
            then_packet(two_packets(), MeshStream(two_packets()).composer().packet(MainStep{.at = {.tick = 31}})));
  c.invalid("key-in-the-past", "A key packet at tick 29, after tick 30, begins anew; the record cannot say so.",
            {"invalid", "R-FIL-7"},
            then_packet(two_packets(), two_packets().composer().packet(MainStep{.at = {.tick = 29, .key = true}})));
  c.invalid("baseline-in-the-past", "A packet on an older baseline, at tick 29, after tick 30; the record cannot say so.", tick,
            then_packet(two_packets(4), two_packets(4).composer().packet(MainStep{.at = {.tick = 29, .baseline = 2}})));
  c.invalid("tick-over-limit", "A key packet at tick 2^32 - 1; no record can say so.", tick,
            then_packet(two_packets(), two_packets().composer().packet(MainStep{.at = {.tick = kLastTick + 1ll, .key = true}})));
  c.invalid("tick-runs-over", "late leads from tick 30 to 2^32 - 1 and beyond; no record can say so.", tick, [] {
    MeshStream stream(only(main_mesh()));
    stream.add(MainStep{.at = {.tick = kLastTick, .key = true}});
    stream.add_packet(kLastTick, coded_main_packet(1, [&](RangeEncoder& coder, MainModels& models) {
                        coder.bit(models.key, 0);
                        coder.signed_value(models.late, std::numeric_limits<std::int32_t>::max());
                      }));
    return stream.bytes();
  }());
}

void add_head_rules(Catalogue& c) {
  const Rejection triangle{"invalid", "R-MES-9"}, bound{"invalid", "R-MES-10"};
  c.invalid("triangle-3", "Triangle 3 of 3: its number has two bits.", triangle,
            then_coded([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.touched[1], 1);
              coder.bit(models.same_triangle, 0);
              coder.bit(models.near_triangle, 0);
              coder.raw(2, 3);
            }));
  c.invalid("near-place-1", "Place 1 in a list of one triangle.", triangle,
            then_coded([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.touched[1], 1);
              coder.bit(models.same_triangle, 0);
              coder.bit(models.near_triangle, 1);
              coder.tree<6>(models.near_place, 1);
            }));
  c.invalid("near-place-63", "Place 63: lists are shortened to 63.", triangle, [] {
    MeshStream stream(only({.shape = flat_fan(100)}));
    stream.add(MainStep{.at = {.tick = 0, .key = true}, .triangle = 5u});
    stream.add_packet(1, coded_main_packet(1, [](RangeEncoder& coder, MainModels& models) {
                        coder.bit(models.key, 0);
                        coder.signed_value(models.late, 0);
                        coder.bit(models.touched[1], 1);
                        coder.bit(models.same_triangle, 0);
                        coder.bit(models.near_triangle, 1);
                        coder.tree<6>(models.near_place, 63);
                      }));
    return stream.bytes();
  }());
  const auto touched = [](RangeEncoder& coder, MainModels& models, std::int32_t change) {
    coder.bit(models.touched[1], 1);
    coder.bit(models.same_triangle, 1);
    coder.signed_value(models.haptic, change);
  };
  c.invalid("haptic-169", "haptic is 169.", bound, then_coded([&](RangeEncoder& coder, MainModels& models) {
              touched(coder, models, 157);
              coder.bit(models.same_visual, 1);
            }));
  c.invalid("haptic-far-beyond", "haptic_change is 2^31 - 1.", bound, then_coded([&](RangeEncoder& coder, MainModels& models) {
              touched(coder, models, std::numeric_limits<std::int32_t>::max());
              coder.bit(models.same_visual, 1);
            }));
  c.invalid("visual-over-limit", "visual is 2^28 + 1.", bound, then_coded([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.touched[1], 0);
              coder.bit(models.same_visual, 0);
              coder.magnitude(models.visual, (1u << 28) + 1);
            }));
  c.invalid("triangle-then-too-wide", "Triangle 3 of 3, then visual of 33 bits: the whole head is read first.", wider(),
            then_coded([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.touched[1], 1);
              coder.bit(models.same_triangle, 0);
              coder.bit(models.near_triangle, 0);
              coder.raw(2, 3);
              coder.signed_value(models.haptic, 0);
              coder.bit(models.same_visual, 0);
              too_wide(coder, models.visual);
            }));
  c.invalid("visual-then-too-wide", "visual is 2^28 + 1, then a coefficient of 33 bits: the head is judged first.", bound,
            then_coded([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.touched[1], 0);
              coder.bit(models.same_visual, 0);
              coder.magnitude(models.visual, (1u << 28) + 1);
              coder.tree<2>(models.density[1], 0);
              too_wide(coder, models.coefficient[0][0]);
            }));
}

void add_widths(Catalogue& c) {
  const auto first_symbols = [](auto code) { return then_packet(two_packets(4), coded_main_packet(2, code)); };
  c.invalid("tick-delta-33-bits", "tick_delta has 33 bits.", wider(), first_symbols([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.key, 1);
              too_wide(coder, models.tick);
            }));
  c.invalid("baseline-delta-33-bits", "baseline_delta has 33 bits.", wider(),
            first_symbols([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.key, 0);
              too_wide(coder, models.baseline);
            }));
  c.invalid("late-32-bits", "late is 2^31.", wider(), first_symbols([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.key, 0);
              coder.magnitude(models.baseline, 1);
              coder.magnitude(models.late, 1u << 31);
              coder.raw(1, 0);
            }));
  c.invalid("haptic-33-bits", "haptic_change has 33 bits.", wider(), then_coded([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.touched[1], 1);
              coder.bit(models.same_triangle, 1);
              too_wide(coder, models.haptic);
            }));
  c.invalid("coefficient-33-bits", "A coefficient has 33 bits.", wider(), then_coded([](RangeEncoder& coder, MainModels& models) {
              quiet_head(coder, models);
              coder.signed_value(models.coefficient[0][0], 0);
              too_wide(coder, models.coefficient[0][0]);
            }));
  c.invalid("component-32-bits", "A component of a residual is -2^31.", wider(),
            then_coded([](RangeEncoder& coder, MainModels& models) {
              quiet_head(coder, models);
              for (int k = 0; k < 2; ++k) coder.signed_value(models.coefficient[0][0], 0);
              const VertexHierarchy order = vertex_hierarchy(only(main_mesh()).parsed().meshes[0]);
              const std::size_t level = std::min<std::size_t>(order.level[order.order[0]], 2);
              coder.bit(models.significant[1][0][0][level], 1);
              coder.magnitude(models.component[0][level][0], 1u << 31);
              coder.raw(1, 1);
            }));
}

void add_ends(Catalogue& c) {
  const Bytes good = two_packets().composer().packet(MainStep{.at = {.tick = 30}, .residuals = [](const VertexPlace&) {
                                                                return Vec3i{1, -1, 77};
                                                              }});
  c.invalid("byte-left-over", "One byte more than the decoder takes.", {"malformed", "R-RNG-2"},
            then_packet(two_packets(), good + Bytes{1, 2, 3, 4}));
  c.invalid("zero-left-over", "A byte more than the decoder takes, the last one 0: R-RNG-2 is checked first.",
            {"malformed", "R-RNG-2"}, then_packet(two_packets(), good + Bytes{0, 0, 0, 0}));
  c.invalid("zero-at-end", "The payload's last byte is 0.", {"malformed", "R-RNG-3"},
            then_packet(two_packets(), good + Bytes{0}));
  c.invalid("all-ones", "A payload of ff: the first symbols are too wide.", wider(),
            then_packet(two_packets(), Bytes{2, 0} + Bytes(8, 0xff)));
}

/// A third packet of profile thesis, of vertex 0, after one change.
template <class Change>
Bytes thesis(Change change) {
  RawThesis raw{.sequence = 2, .key = 0, .list = thesis_symbols({0}, 8), .errors = thesis_symbols({3, 4, 5}, 4)};
  change(raw);
  return then_packet(two_thesis_packets(), raw.bytes());
}

void add_thesis_head(Catalogue& c) {
  const Rejection cut{"truncated", "R-MES-11"}, malformed{"malformed", "R-MES-11"}, value{"invalid", "R-MES-12"};
  c.invalid("thesis-packet-of-2-bytes", "A sequence number and nothing more.", cut, then_packet(two_thesis_packets(), {2, 0}));
  c.invalid("thesis-cut-head", "The packet ends inside lowest.", cut,
            then_packet(two_thesis_packets(), {2, 0, 0, 0, 1, 0, 0x80}));
  c.invalid("thesis-key-2", "key is 2.", malformed, thesis([](RawThesis& r) { r.key = 2; }));
  c.invalid("thesis-key-2-cut", "key is 2, and nothing follows: the first fault counts.", malformed,
            then_packet(two_thesis_packets(), {2, 0, 2}));
  c.invalid("thesis-overlong-count", "count 1 is written in two bytes.", malformed, thesis([](RawThesis& r) {
              r.count = {0x81, 0x00};
            }));
  c.invalid("thesis-overlong-then-cut", "count 1 is written in two bytes, then the packet ends: the first fault counts.",
            malformed, then_packet(two_thesis_packets(), {2, 0, 0, 0, 0x81, 0x00}));
  c.invalid("thesis-list-cut", "The list is one byte longer than what is left.", cut,
            thesis([](RawThesis& r) { r.list_bytes = varint(r.list.size() + r.errors.size() + 1); }));
  c.invalid("thesis-list-of-2-64", "list_bytes is 2^64 - 1.", cut,
            thesis([](RawThesis& r) { r.list_bytes = varint(~std::uint64_t{0}); }));
  c.invalid("thesis-tick-delta-33-bits", "tick_delta is 2^32.", value,
            thesis([](RawThesis& r) { r.tick_delta = varint(std::uint64_t{1} << 32); }));
  c.invalid("thesis-count-0", "count is 0.", value, thesis([](RawThesis& r) { r.count = {0}; }));
  c.invalid("thesis-count-10", "count is 10 of 9 vertices.", value, thesis([](RawThesis& r) { r.count = {10}; }));
  c.invalid("thesis-lowest", "lowest is 2^28 + 1.", value, thesis([](RawThesis& r) { r.lowest = zigzag_varint((1 << 28) + 1); }));
  c.invalid("thesis-range", "range is 2^29 + 1.", value, thesis([](RawThesis& r) { r.range = varint((1 << 29) + 1); }));
  c.invalid("thesis-count-before-list", "count is 0, and the list is cut: R-MES-12 is checked before the list's size.", value,
            thesis([](RawThesis& r) {
              r.count = {0};
              r.list_bytes = varint(1000);
            }));
}

void add_thesis_rules(Catalogue& c) {
  c.invalid("thesis-baseline-delta-5", "baseline_delta is 5; baseline_span is 4.", {"invalid", "R-PKT-3"},
            then(two_thesis_packets(4), ThesisStep{.at = {.tick = 31, .baseline = 5}, .vertices = {{0}}}));
  c.invalid("thesis-lost-baseline", "A packet is missing; the next one builds on it.", {"state", "R-PKT-4"},
            then(two_thesis_packets(), ThesisStep{.at = {.tick = 31, .sequence = std::uint16_t{3}}, .vertices = {{0}}}));
  c.invalid(
      "thesis-stale", "A packet older than the current state.", {"state", "R-PKT-5"},
      then(two_thesis_packets(), ThesisStep{.at = {.tick = 31, .key = true, .sequence = std::uint16_t{0}}, .vertices = {{0}}}));
  c.invalid("thesis-key-in-the-past", "A key packet at tick 0, after tick 30, begins anew; the record cannot say so.",
            {"invalid", "R-FIL-7"}, thesis([](RawThesis& r) { r.key = 1; }));
  c.invalid("thesis-tick-over-limit", "A packet at tick 2^32 - 1; no record can say so.", {"invalid", "R-MES-8"},
            thesis([](RawThesis& r) { r.tick_delta = varint(kLastTick - 29); }));
  c.invalid("thesis-gap-beyond", "A gap of 9: there are 9 vertices.", {"invalid", "R-MES-13"},
            thesis([](RawThesis& r) { r.list = thesis_symbols({9}, 8); }));
  c.invalid("thesis-second-gap-beyond", "Vertex 8, then one more.", {"invalid", "R-MES-13"}, thesis([](RawThesis& r) {
              r.count = {2};
              r.list = thesis_symbols({8, 0}, 8);
            }));
  c.invalid("thesis-gap-255", "A gap of 255 and more.", {"invalid", "R-MES-13"}, thesis([](RawThesis& r) {
              r.list = thesis_symbols({255, 255, 255}, 8);
            }));
  c.invalid("thesis-list-left-over", "The list has bytes that the decoder does not take.", {"malformed", "R-RNG-2"},
            thesis([](RawThesis& r) { r.list = Bytes{0, 0, 0, 0, 1, 2, 3}; }));
  c.invalid("thesis-list-zero-at-end", "The list's last byte is 0.", {"malformed", "R-RNG-3"},
            thesis([](RawThesis& r) { r.list = r.list + Bytes{0}; }));
  c.invalid("thesis-errors-left-over", "The errors have bytes that the decoder does not take.", {"malformed", "R-RNG-2"},
            thesis([](RawThesis& r) { r.errors = r.errors + Bytes{1, 2, 3, 4, 5, 6}; }));
  c.invalid("thesis-errors-zero-at-end", "The errors' last byte is 0.", {"malformed", "R-RNG-3"},
            thesis([](RawThesis& r) { r.errors = r.errors + Bytes{0}; }));
}

}  // namespace

void add_mesh_rules(Catalogue& c) {
  add_packet_rules(c);
  add_head_rules(c);
  add_widths(c);
  add_ends(c);
  add_thesis_head(c);
  add_thesis_rules(c);
}

}  // namespace tactus::conformance
