// SPDX-License-Identifier: Apache-2.0
/// Two faults of a rigid packet at once: the one that is read first counts.
#include "conformance/make_vectors/catalogue.h"

namespace tactus::conformance {
namespace {

/// Packets 100 and 101 at ticks 10 and 30, then one with any head.
Bytes rigid_head(const RigidHead& head, std::uint8_t span = 4) {
  RawHeader raw;
  raw.baseline_span = span;
  raw.objects = {{"a"}, {"b"}};
  Stream stream(raw);
  stream.add({.tick = 10, .key = true, .sequence = std::uint16_t{100}});
  stream.add({.tick = 30});
  return stream.add_packet(30, raw_packet(stream.header(), 102, head, {})).bytes();
}

/// A magnitude of 33 bits.
void too_wide(RangeEncoder& coder, MagnitudeModel& model) {
  coder.tree<4>(model, 15);
  coder.raw(5, 18);
}

/// Packets 0 and 1 of two objects at ticks 10 and 30, then any packet.
Bytes then_packet(const Bytes& packet, std::int64_t tick = 30) {
  RawHeader raw;
  raw.baseline_span = 4;
  raw.objects = {{"a"}, {"b"}};
  Stream stream(raw);
  stream.add({.tick = 10, .key = true});
  stream.add({.tick = 30});
  return stream.add_packet(tick, packet).bytes();
}

/// The two packets, then packet 2, whose symbols after `tick_delta` are written by `code`.
template <class Code>
Bytes then_coded(Code code) {
  return then_packet(coded_packet(2, [&](RangeEncoder& coder, RigidModels& models) {
    coder.bit(models.key, 0);
    coder.magnitude(models.baseline, 1);
    coder.magnitude(models.tick_delta, 0);
    code(coder, models);
  }));
}

}  // namespace

void add_rigid_orders(Catalogue& c) {
  c.invalid("count-before-baseline", "baseline_delta is 0, and count is wider than 32 bits.", {"malformed", "R-RNG-4", "R-PKT-3"},
            [] {
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
  c.invalid("baseline-before-count-0", "baseline_delta and count are 0.", {"invalid", "R-PKT-3", "R-RIG-3"},
            rigid_head({{false, 0, 0}, 0}));
  c.invalid("tick-before-count-0", "A tick in the past, and count 0.", {"invalid", "R-RIG-1", "R-RIG-3"},
            rigid_head({{false, 2, 0}, 0}));
  c.invalid("baseline-before-tick", "The baseline was never there, and the tick runs over.", {"state", "R-PKT-4", "R-RIG-1"},
            rigid_head({{false, 3, 0xffffffffu}, 1}));
  RawHeader two;
  two.baseline_span = 4;
  two.objects = {{"a"}, {"b"}};
  c.invalid("gap-before-residual", "A gap beyond the objects, then a residual of 33 bits.", {"invalid", "R-RIG-4", "R-RNG-4"},
            then_coded([](RangeEncoder& coder, RigidModels& models) {
              coder.magnitude(models.count, 1);
              coder.magnitude(models.gap, 2);
              coder.tree<2>(models.reason, 0);
              coder.tree<4>(models.level, 0);
              too_wide(coder, models.residual[0].pose[0]);
            }));
  c.invalid("residual-before-length", "A rotation that is too long, then an angular velocity of 33 bits.",
            {"malformed", "R-RNG-4", "R-RIG-6"}, then_coded([](RangeEncoder& coder, RigidModels& models) {
              coder.magnitude(models.count, 1);
              coder.magnitude(models.gap, 0);
              coder.tree<2>(models.reason, 0);
              coder.tree<4>(models.level, 0);
              Vec3i pose{}, motion{};
              code_residual(coder, models.residual[0], 7, Reason::request, pose, motion);
              coder.signed_value(models.residual[1].pose[0], kHalfCircle + 1);
              for (int i = 0; i < 2; ++i) coder.signed_value(models.residual[1].pose[11], 0);
              too_wide(coder, models.residual[1].motion[4]);
            }));
  c.invalid("length-before-next-gap", "A rotation that is too long, then a gap beyond the objects.",
            {"invalid", "R-RIG-6", "R-RIG-4"}, then_coded([&two](RangeEncoder& coder, RigidModels& models) {
              coder.magnitude(models.count, 2);
              coder.magnitude(models.gap, 0);
              CodedUpdate too_far{.residual = {{{{}, {}, {kHalfCircle + 1, 0, 0}, {}}}}};
              code_update(coder, models, *two.parsed(), 0, too_far);
              coder.magnitude(models.gap, 1);
            }));
  c.invalid("end-before-record-tick", "Bytes left over, and a record of another tick.", {"malformed", "R-RNG-2", "R-FIL-7"},
            then_packet(raw_packet(*two.parsed(), 2, {{false, 1, 0}, 1}, std::vector<RawUpdate>(1)) + Bytes(16, 1), 40));
}

}  // namespace tactus::conformance
