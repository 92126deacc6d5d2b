// SPDX-License-Identifier: Apache-2.0
/// Every rule of packets of deformable objects, broken once or more. Each file begins with packets that are good.
#include <algorithm>
#include <limits>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"

namespace tactus::conformance {
namespace {

constexpr std::uint32_t kLastTick = 0xfffffffe;
Rejection wider() { return {"malformed", "R-RNG-4"}; }

/// The two packets, then one at tick 31 whose symbols after `late` are written by `code`.
template <class Code>
Bytes then_coded(Code code) {
  return then_packet(two_main_packets(), coded_main_packet(2, [&](RangeEncoder& coder, MainModels& models) {
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

void add_tick_rule(Catalogue& c) {
  const Rejection tick{"invalid", "R-DEF-8"};
  c.invalid("baseline-in-the-past", "A packet on an older baseline, at tick 29, after tick 30; the record cannot say so.", tick,
            then_packet(two_main_packets(4), two_main_packets(4).composer().packet(MainStep{.at = {.tick = 29, .baseline = 2}})));
  c.invalid("tick-over-limit", "A key packet at tick 2^32 - 1; no record can say so.", tick,
            then_packet(two_main_packets(),
                        two_main_packets().composer().packet(MainStep{.at = {.tick = kLastTick + 1ll, .key = true}})));
  c.invalid("tick-runs-over", "late goes from tick 30 to 2^32 - 1 and beyond; no record can say so.", tick, [] {
    DeformableStream stream(main_scene());
    stream.add(MainStep{.at = {.tick = kLastTick, .key = true}});
    stream.add_packet(kLastTick, coded_main_packet(1, [&](RangeEncoder& coder, MainModels& models) {
                        coder.bit(models.key, 0);
                        coder.signed_value(models.late, std::numeric_limits<std::int32_t>::max());
                      }));
    return stream.bytes();
  }());
}

void add_head_rules(Catalogue& c) {
  const Rejection triangle{"invalid", "R-DEF-9"}, bound{"invalid", "R-DEF-10"};
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
    DeformableStream stream(only({.shape = flat_fan(100)}));
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
  c.invalid("triangle-then-too-wide", "Triangle 3 of 3, then visual of 33 bits: the whole head is read first.",
            {"malformed", "R-RNG-4", "R-DEF-9"}, then_coded([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.touched[1], 1);
              coder.bit(models.same_triangle, 0);
              coder.bit(models.near_triangle, 0);
              coder.raw(2, 3);
              coder.signed_value(models.haptic, 0);
              coder.bit(models.same_visual, 0);
              too_wide(coder, models.visual);
            }));
  c.invalid("visual-then-too-wide", "visual is 2^28 + 1, then a coefficient of 33 bits: the head is judged first.",
            {"invalid", "R-DEF-10", "R-RNG-4"}, then_coded([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.touched[1], 0);
              coder.bit(models.same_visual, 0);
              coder.magnitude(models.visual, (1u << 28) + 1);
              coder.tree<2>(models.density[1], 0);
              too_wide(coder, models.coefficient[0][0]);
            }));
}

void add_widths(Catalogue& c) {
  const auto first_symbols = [](auto code) { return then_packet(two_main_packets(4), coded_main_packet(2, code)); };
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
              const VertexHierarchy order = vertex_hierarchy(main_scene().parsed()->deformables[0]);
              const std::size_t level = std::min<std::size_t>(order.depth[order.order[0]], 2);
              coder.bit(models.significant[1][0][0][level], 1);
              coder.magnitude(models.component[0][level][0], 1u << 31);
              coder.raw(1, 1);
            }));
}

void add_ends(Catalogue& c) {
  const Bytes good = two_main_packets().composer().packet(MainStep{.at = {.tick = 30}, .residuals = [](const VertexPrediction&) {
                                                                     return Vec3i{1, -1, 77};
                                                                   }});
  c.invalid("byte-left-over", "One byte more than the decoder takes.", {"malformed", "R-RNG-2"},
            then_packet(two_main_packets(), good + Bytes{1, 2, 3, 4}));
  c.invalid("zero-left-over", "A byte more than the decoder takes, the last one 0.", {"malformed", "R-RNG-2", "R-RNG-3"},
            then_packet(two_main_packets(), good + Bytes{0, 0, 0, 0}));
  c.invalid("zero-at-end", "The payload's last byte is 0.", {"malformed", "R-RNG-3"},
            then_packet(two_main_packets(), good + Bytes{0}));
  c.invalid("all-ones", "A payload of ff: the first symbols are too wide.", wider(),
            then_packet(two_main_packets(), Bytes{2, 0} + Bytes(8, 0xff)));
}

/// A third packet of profile thesis, of vertex 0, after one change.
template <class Change>
Bytes thesis(Change change) {
  RawThesis raw{.sequence = 2, .key = 0, .list = thesis_symbols({0}, 8), .errors = thesis_symbols({3, 4, 5}, 4)};
  change(raw);
  return then_packet(two_thesis_packets(), raw.bytes());
}

void add_thesis_head(Catalogue& c) {
  const Rejection cut{"truncated", "R-DEF-11"}, malformed{"malformed", "R-DEF-11"}, value{"invalid", "R-DEF-12"};
  c.invalid("thesis-packet-of-2-bytes", "A sequence number and nothing more.", cut, then_packet(two_thesis_packets(), {2, 0}));
  c.invalid("thesis-cut-head", "The packet ends inside lowest.", cut,
            then_packet(two_thesis_packets(), {2, 0, 0, 0, 1, 0, 0x80}));
  c.invalid("thesis-key-2", "key is 2.", malformed, thesis([](RawThesis& r) { r.key = 2; }));
  c.invalid("thesis-key-2-cut", "key is 2, and nothing follows.", {"malformed", "R-DEF-11", "R-DEF-11"},
            then_packet(two_thesis_packets(), {2, 0, 2}));
  c.invalid("thesis-overlong-count", "count 1 is written in two bytes.", malformed, thesis([](RawThesis& r) {
              r.count = {0x81, 0x00};
            }));
  c.invalid("thesis-overlong-then-cut", "count 1 is written in two bytes, then the packet ends.",
            {"malformed", "R-DEF-11", "R-DEF-11"}, then_packet(two_thesis_packets(), {2, 0, 0, 0, 0x81, 0x00}));
  c.invalid("thesis-list-cut", "The list is one byte longer than what is left.", cut,
            thesis([](RawThesis& r) { r.list_bytes = varint(r.list.size() + r.errors.size() + 1); }));
  c.invalid("thesis-list-of-2-64", "list_bytes is 2^64 - 1.", cut,
            thesis([](RawThesis& r) { r.list_bytes = varint(~std::uint64_t{0}); }));
  c.invalid("thesis-tick-delta-33-bits", "tick_delta is 2^32.", value,
            thesis([](RawThesis& r) { r.tick_delta = varint(std::uint64_t{1} << 32); }));
  c.invalid("thesis-count-0", "count is 0.", value, thesis([](RawThesis& r) { r.count = {0}; }));
  c.invalid("thesis-count-10", "count is 10 of 9 vertices.", value, thesis([](RawThesis& r) { r.count = {10}; }));
  c.invalid("thesis-lowest", "lowest is 2^28 + 1.", value, thesis([](RawThesis& r) { r.lowest = zigzag_varint((1 << 28) + 1); }));
  c.invalid("thesis-lowest-negative", "lowest is -(2^28 + 1).", value,
            after_one_thesis_packet(1, {.lowest = zigzag_varint(-(1 << 28) - 1), .list = thesis_symbols({0}, 8)}));
  c.invalid("thesis-range", "range is 2^29 + 1.", value, thesis([](RawThesis& r) { r.range = varint((1 << 29) + 1); }));
  c.invalid("thesis-count-before-list", "count is 0, and the list is cut.", {"invalid", "R-DEF-12", "R-DEF-11"},
            thesis([](RawThesis& r) {
              r.count = {0};
              r.list_bytes = varint(1000);
            }));
}

void add_thesis_rules(Catalogue& c) {
  c.invalid("thesis-tick-over-limit", "A packet at tick 2^32 - 1; no record can say so.", {"invalid", "R-DEF-8"},
            thesis([](RawThesis& r) { r.tick_delta = varint(kLastTick - 29); }));
  c.invalid("thesis-gap-beyond", "A gap of 9: there are 9 vertices.", {"invalid", "R-DEF-13"},
            thesis([](RawThesis& r) { r.list = thesis_symbols({9}, 8); }));
  c.invalid("thesis-second-gap-beyond", "Vertex 8, then one more.", {"invalid", "R-DEF-13"}, thesis([](RawThesis& r) {
              r.count = {2};
              r.list = thesis_symbols({8, 0}, 8);
            }));
  c.invalid("thesis-gap-255", "A gap of 255 and more.", {"invalid", "R-DEF-13"}, thesis([](RawThesis& r) {
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

void add_deformable_rules(Catalogue& c) {
  add_tick_rule(c);
  add_head_rules(c);
  add_widths(c);
  add_ends(c);
  add_thesis_head(c);
  add_thesis_rules(c);
}

}  // namespace tactus::conformance
