// SPDX-License-Identifier: Apache-2.0
/// Every rule of rigid packets, broken once or more. Each file begins with packets that are good.
#include <limits>

#include "conformance/make_vectors/catalogue.h"

namespace tactus::conformance {
namespace {

constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();

std::vector<Update> moved(std::int32_t by) { return {{0, Reason::visual, 0, {{{by, 0, 0}}}}}; }

RawHeader two(std::uint8_t span = 1) {
  RawHeader header;
  header.baseline_span = span;
  header.objects = {{"a"}, {"wall", Dof::none}, {"b"}};
  return header;
}

/// Packets 100 and 101 at ticks 10 and 30.
Stream two_packets(std::uint8_t span = 1) {
  Stream stream(two(span));
  stream.add({.tick = 10, .updates = moved(4), .key = true, .sequence = std::uint16_t{100}});
  stream.add({.tick = 30, .updates = moved(5)});
  return stream;
}

/// The two packets, then packet 102 with any head and any updates.
Bytes then_raw(const RigidHead& head, const std::vector<RawUpdate>& updates) {
  Stream stream = two_packets();
  return stream.add_packet(30, raw_packet(stream.header(), 102, head, updates)).bytes();
}

void add_tick_rule(Catalogue& c) {
  const Rejection tick{"invalid", "R-RIG-1"};
  c.invalid("tick-over-limit", "A key packet at tick 2^32 - 1; no record can say so.", tick,
            then_raw({{true, 1, 0xffffffffu}, 1}, {{}}));
  Stream late(two());
  late.add({.tick = 4294967294, .updates = moved(1), .key = true, .sequence = std::uint16_t{0}});
  c.invalid(
      "tick-runs-over", "tick_delta goes from tick 2^32 - 2 to 2^32 - 1; no record can say so.", tick,
      Stream(late).add_packet(4294967294, raw_packet(late.header(), 1, {{false, 1, 1}, 1}, std::vector<RawUpdate>(1))).bytes());
  Stream wrapped(late);
  c.invalid("tick-runs-over-far", "tick_delta 2^32 - 1 goes from tick 2^32 - 2 beyond 32 bits.", tick,
            wrapped.add_packet(4294967294, raw_packet(late.header(), 1, {{false, 1, 0xffffffffu}, 1}, std::vector<RawUpdate>(1)))
                .bytes());
  Stream older = two_packets(4);
  const Bytes packet = older.packet({.tick = 29, .updates = moved(1), .baseline = 2});
  c.invalid("baseline-in-the-past", "A packet on an older baseline, at tick 29, after tick 30; the record cannot say so.", tick,
            older.add_packet(30, packet).bytes());
}

void add_update_rules(Catalogue& c) {
  const Rejection count{"invalid", "R-RIG-3"}, object{"invalid", "R-RIG-4"};
  c.invalid("count-0", "A packet that names no object.", count, then_raw({{false, 1, 0}, 0}, {}));
  c.invalid("count-3", "count is 3; two objects move.", count, then_raw({{false, 1, 0}, 3}, {}));
  c.invalid("count-2-32", "count is 2^32 - 1.", count, then_raw({{false, 1, 0}, 0xffffffffu}, {}));
  RawHeader still;
  still.objects = {{"wall", Dof::none}};
  Stream nothing(still);
  c.invalid("nothing-moves", "A packet in a scene without moving objects.", count,
            nothing
                .add_packet(0, coded_packet(0,
                                            [&](RangeEncoder& coder, RigidModels& models) {
                                              RigidHead head{{true, 1, 0}, 1};
                                              code_head(coder, models, nothing.header(), head);
                                            }))
                .bytes());
  c.invalid("first-gap-beyond", "The first gap goes past the last moving object.", object,
            then_raw({{false, 1, 0}, 1}, {{2, {}}}));
  c.invalid("second-gap-beyond", "The second gap goes past the last moving object.", object,
            then_raw({{false, 1, 0}, 2}, {{0, {}}, {1, {}}}));
  c.invalid("gap-wraps", "A second gap of 2^32 - 1 would lead back to the first object in 32-bit arithmetic.", object,
            then_raw({{false, 1, 0}, 2}, {{0, {}}, {0xffffffffu, {}}}));
}

Bytes turned(std::uint8_t dof, const Vec3i& residual, std::uint8_t level) {
  RawHeader header;
  header.objects = {{"object", dof}};
  Stream stream(header);
  stream.add({.tick = 1, .updates = {{}}, .key = true});
  return stream.add({.tick = 2, .updates = {{0, Reason::visual, level, {{{}, {}, residual, {}}}}}}).bytes();
}

void add_rotation_rule(Catalogue& c) {
  const Rejection length{"invalid", "R-RIG-6"};
  c.invalid("rotation-about-one-axis", "A rotation about x alone, residual 2^rotation_exp + 1.", length,
            turned(Dof::rx, {kHalfCircle + 1, 0, 0}, 0));
  c.invalid("rotation-component", "A component of a rotation residual is -(2^rotation_exp + 1).", length,
            turned(Dof::all, {0, -(kHalfCircle + 1), 0}, 0));
  c.invalid("rotation-length", "No component is too long; together they are, by the least there is.", length,
            turned(Dof::all, {kHalfCircle, 0, 1}, 0));
  c.invalid("rotation-at-level-15", "The largest residual at the coarsest level: 46 bits.", length,
            turned(Dof::all, {0, 0, kLargest}, 15));
}

}  // namespace

void add_rigid_rules(Catalogue& catalogue) {
  add_tick_rule(catalogue);
  add_update_rules(catalogue);
  add_rotation_rule(catalogue);
}

}  // namespace tactus::conformance
