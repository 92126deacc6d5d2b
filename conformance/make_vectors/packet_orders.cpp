// SPDX-License-Identifier: Apache-2.0
/// Two faults of a packet at once: the one that is read first counts. More of them are in orders.cpp.
#include <utility>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/mesh_build.h"

namespace tactus::conformance {
namespace {

Rejection wider() { return {"malformed", "R-RNG-4"}; }
Rejection left_over() { return {"malformed", "R-RNG-2"}; }
Rejection late() { return {"state", "R-PKT-5"}; }
Rejection no_such_baseline() { return {"invalid", "R-PKT-3"}; }

/// A magnitude of 33 bits.
void too_wide(RangeEncoder& coder, MagnitudeModel& model) {
  coder.tree<4>(model, 15);
  coder.raw(5, 18);
}

/// Packets 0 and 1 of two objects at ticks 10 and 30, then any packet.
Bytes rigid(const Bytes& packet, std::int64_t tick = 30) {
  RawHeader raw;
  raw.baseline_span = 4;
  raw.objects = {{"a"}, {"b"}};
  Stream stream(raw);
  stream.add({.tick = 10, .key = true});
  stream.add({.tick = 30});
  return stream.add_packet(tick, packet).bytes();
}

/// Packet 2, whose symbols after `tick_delta` are written by `code`.
template <class Code>
Bytes rigid_packet(Code code) {
  return coded_packet(2, [&](RangeEncoder& coder, RigidModels& models) {
    coder.bit(models.key, 0);
    coder.magnitude(models.baseline, 1);
    coder.magnitude(models.tick_delta, 0);
    code(coder, models);
  });
}

}  // namespace

void add_rigid_packet_orders(Catalogue& c) {
  c.invalid("late-before-all", "A late packet whose payload breaks R-RNG-4.", late(), rigid({1, 0, 0xff, 0xff, 0xff, 0xff}));
  RawHeader two;
  two.baseline_span = 4;
  two.objects = {{"a"}, {"b"}};
  c.invalid("baseline-delta-before-ahead", "baseline_delta is 0, and the packet 32768 ahead.", no_such_baseline(),
            rigid(raw_packet(two.parsed(), 32769, {false, 0, 0, 1}, std::vector<RawUpdate>(1))));
  c.invalid("gap-before-residual", "A gap beyond the objects, then a residual of 33 bits.", {"invalid", "R-RIG-4"},
            rigid(rigid_packet([](RangeEncoder& coder, RigidModels& models) {
              coder.magnitude(models.count, 1);
              coder.magnitude(models.gap, 2);
              coder.tree<2>(models.reason, 0);
              coder.tree<3>(models.level, 0);
              too_wide(coder, models.residual[0][0]);
            })));
  c.invalid("residual-before-length", "A rotation that is too long, then a spin of 33 bits.", wider(),
            rigid(rigid_packet([](RangeEncoder& coder, RigidModels& models) {
              coder.magnitude(models.count, 1);
              coder.magnitude(models.gap, 0);
              coder.tree<2>(models.reason, 0);
              coder.tree<3>(models.level, 0);
              coder.signed_value(models.residual[0][0], 0);
              for (int i = 0; i < 2; ++i) coder.signed_value(models.residual[0][4], 0);
              for (int i = 0; i < 3; ++i) coder.signed_value(models.residual[1][4], 0);
              coder.signed_value(models.residual[2][0], kHalfTurn + 1);
              for (int i = 0; i < 2; ++i) coder.signed_value(models.residual[2][7], 0);
              too_wide(coder, models.residual[3][7]);
            })));
  c.invalid("length-before-next-gap", "A rotation that is too long, then a gap beyond the objects.", {"invalid", "R-RIG-6"},
            rigid(rigid_packet([](RangeEncoder& coder, RigidModels& models) {
              coder.magnitude(models.count, 2);
              coder.magnitude(models.gap, 0);
              CodedUpdate too_far{Reason::request, 0, {{{{}, {}, {kHalfTurn + 1, 0, 0}, {}}}}};
              code_update(coder, models, Dof::all, too_far);
              coder.magnitude(models.gap, 1);
            })));
  c.invalid("end-before-record-tick", "Bytes left over, and a record of another tick.", left_over(),
            rigid(raw_packet(two.parsed(), 2, {false, 1, 0, 1}, std::vector<RawUpdate>(1)) + Bytes(8, 1), 40));
}

namespace {

/// Packets 0 and 1 of a sheet at ticks 10 and 30, then any packet.
Bytes main_mesh(const Bytes& packet, std::int64_t tick = 30) {
  MeshStream stream(only({.shape = sheet(2, 2)}, 4));
  stream.add(MainStep{.at = {.tick = 10, .key = true}}).add(MainStep{.at = {.tick = 30}});
  return stream.add_packet(tick, packet).bytes();
}

void add_main(Catalogue& c) {
  c.invalid("late-before-baseline-delta", "baseline_delta is 0, and late 2^31.", wider(),
            main_mesh(coded_main_packet(2, [](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.key, 0);
              coder.magnitude(models.baseline, 0);
              coder.magnitude(models.late, 1u << 31);
              coder.raw(1, 0);
            })));
  c.invalid("baseline-delta-before-ahead", "baseline_delta is 0, and the packet 32768 ahead.", no_such_baseline(),
            main_mesh(coded_main_packet(32769, [](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.key, 0);
              coder.magnitude(models.baseline, 0);
              coder.signed_value(models.late, 0);
            })));
  c.invalid("tick-before-head", "A packet on an older baseline, at tick 11, after tick 30; then visual of 33 bits.",
            {"invalid", "R-MES-8"}, main_mesh(coded_main_packet(2, [](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.key, 0);
              coder.magnitude(models.baseline, 2);
              coder.signed_value(models.late, 0);
              coder.bit(models.touched[0], 0);
              coder.bit(models.same_visual, 0);
              too_wide(coder, models.visual);
            })));
  MeshStream stream(only({.shape = sheet(2, 2)}, 4));
  stream.add(MainStep{.at = {.tick = 10, .key = true}}).add(MainStep{.at = {.tick = 30}});
  c.invalid("end-before-record-tick", "Bytes left over, and a record of another tick.", left_over(),
            main_mesh(stream.composer().packet(MainStep{.at = {.tick = 31}}) + Bytes(8, 1), 40));
}

/// Packets 0 and 1 of profile thesis at ticks 10 and 30, then any packet.
Bytes thesis_mesh(const Bytes& packet) {
  MeshStream stream(only({.shape = sheet(2, 2), .profile = 0, .quant_bits = 4}, 4));
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
  const Rejection cut{"truncated", "R-MES-11"};
  c.invalid("thesis-late-before-cut", "A late packet of a sequence number and nothing more.", late(), thesis_mesh({1, 0}));
  c.invalid("thesis-cut-before-tick-delta", "tick_delta is 2^32; the packet ends before range.", cut,
            thesis_mesh(Bytes{2, 0, 0, 1} + varint(std::uint64_t{1} << 32) + Bytes{1, 0, 0}));
  c.invalid("thesis-list-before-baseline", "baseline_delta is 5 of 4, and the list is cut.", cut, thesis([](RawThesis& r) {
              r.baseline_delta = std::uint8_t{5};
              r.list_bytes = varint(1000);
            }));
  c.invalid("thesis-tick-before-gap", "A packet at tick 2^32 - 1, and a gap of 9 of 9 vertices.", {"invalid", "R-MES-8"},
            thesis([](RawThesis& r) {
              r.tick_delta = varint(0xffffffffu - 30);
              r.list = thesis_symbols({9}, 8);
            }));
  c.invalid("thesis-gap-before-list-end", "A gap of 9 of 9 vertices, and the list's last byte is 0.", {"invalid", "R-MES-13"},
            thesis([](RawThesis& r) { r.list = thesis_symbols({9}, 8) + Bytes{0}; }));
}

}  // namespace

void add_mesh_packet_orders(Catalogue& c) {
  add_main(c);
  add_thesis(c);
}

}  // namespace tactus::conformance
