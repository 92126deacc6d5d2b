// SPDX-License-Identifier: Apache-2.0
/// Packets after an outage, and of a sender that begins anew: spec/40-rigid.md section 2.1.
#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/mesh_build.h"

namespace tactus::conformance {
namespace {

Rejection no_baseline() { return {"state", "R-PKT-4"}; }
Rejection foreign() { return {"state", "R-PKT-7"}; }
Rejection late() { return {"state", "R-PKT-5"}; }
Rejection other_tick() { return {"invalid", "R-FIL-7"}; }

std::vector<Update> moved(std::int32_t by) { return {{0, Reason::visual, 0, {{{by, 0, 0}}}}}; }

constexpr std::uint16_t number(std::int32_t sequence) { return static_cast<std::uint16_t>(sequence); }

/// Packets 100 and 101 at ticks 10 and 30.
Stream two_packets(std::uint8_t span = 1) {
  RawHeader header;
  header.baseline_span = span;
  Stream stream(header);
  stream.add({.tick = 10, .updates = moved(4), .key = true, .sequence = number(100)});
  stream.add({.tick = 30, .updates = moved(5)});
  return stream;
}

/// The two, then a key packet of a sequence number, then one that builds on it.
Bytes with_key(std::int32_t sequence) {
  Stream stream = two_packets();
  stream.add({.tick = 50, .updates = moved(7), .key = true, .sequence = number(sequence)});
  stream.add({.tick = 51, .updates = moved(8)});
  return stream.finish().bytes();
}

/// As far as 16 bits tell, the packet's baseline is a state that is 65536 packets old.
Bytes round_the_numbers() {
  RawHeader header;
  header.baseline_span = 3;
  Stream stream(header);
  for (const std::int32_t sequence : {100, 100 + 32767, 100 + 65534})
    stream.add({.tick = 10, .updates = moved(4), .key = true, .sequence = number(sequence)});
  return stream.add({.tick = 11, .updates = moved(1), .sequence = number(101)}).bytes();
}

/// After a key packet 128 behind, packet 102 would build on the 101 of before.
Bytes forgotten() {
  Stream stream = two_packets(4);
  stream.add({.tick = 50, .updates = moved(7), .key = true, .sequence = number(101 - 128)});
  const Bytes packet = two_packets(4).packet({.tick = 50, .updates = moved(1)});
  return stream.add_packet(50, packet).bytes();
}

RawMesh sheet_of(std::uint8_t profile) { return {.shape = sheet(2, 2), .profile = profile, .quant_bits = 4}; }

/// Packets 0 and 1 at ticks 10 and 30, then one more.
template <class Step>
Bytes mesh_packets(std::uint8_t profile, const Step& first, const Step& second, const Step& third) {
  MeshStream stream(only(sheet_of(profile)));
  return stream.add(first).add(second).add(third).bytes();
}

Bytes main_packets(const MeshPlace& third) {
  return mesh_packets(1, MainStep{.at = {.tick = 10, .key = true}}, MainStep{.at = {.tick = 30}}, MainStep{.at = third});
}

Bytes thesis_packets(const MeshPlace& third) {
  const std::vector<ThesisVertex> vertices{{4, {1, 2, 3}}};
  return mesh_packets(0, ThesisStep{.at = {.tick = 10, .key = true}, .vertices = vertices},
                      ThesisStep{.at = {.tick = 30}, .vertices = vertices}, ThesisStep{.at = third, .vertices = vertices});
}

/// Sequences 5 to 10 come twice within the 64 states that are kept.
Bytes mesh_sequence_repeats() {
  MeshStream stream(only(sheet_of(1), 64));
  Random random(740);
  std::int64_t tick = 0;
  for (const std::int32_t start : {5, 32772, 65539}) {
    for (std::int32_t i = 0; i < 7; ++i)
      stream.add(MainStep{.at = {.tick = ++tick, .key = i == 0, .sequence = number(start + i)},
                          .residuals = random_residuals(random, 5, 200)});
  }
  return stream.finished();
}

}  // namespace

void add_rigid_outages(Catalogue& c) {
  c.valid("key-after-outage", "40000 packets are missing before a key packet; the next builds on it.", with_key(101 + 40000),
          {"R-PKT-4", "R-PKT-5"});
  c.valid("key-128-behind", "A key packet 128 behind begins anew.", with_key(101 - 128), {"R-PKT-5"});
  c.invalid("key-127-behind", "A key packet 127 behind is late.", late(), with_key(101 - 127));
  c.invalid("32768-ahead", "A packet 32768 ahead that is not key.", foreign(),
            two_packets().add({.tick = 50, .updates = moved(1), .sequence = number(101 + 32768)}).bytes());
  c.invalid("128-behind", "A packet 128 behind that is not key.", foreign(),
            two_packets().add({.tick = 50, .updates = moved(1), .sequence = number(101 - 128)}).bytes());
  c.invalid("round-the-numbers", "The baseline's sequence is that of a kept state 65536 packets ago.", no_baseline(),
            round_the_numbers());
  c.invalid("begun-anew-forgets", "A key packet begins anew; the next one builds on a state before it.", no_baseline(),
            forgotten());
  c.invalid("65536-missing", "65536 packets are missing: numbers fit, the tick is 70000 too early.", other_tick(),
            two_packets().add_packet(70030, two_packets().packet({.tick = 31, .updates = moved(1)})).bytes());
}

void add_mesh_outages(Catalogue& c) {
  c.valid("key-after-outage", "40000 packets are missing before a key packet.",
          main_packets({.tick = 50, .key = true, .sequence = number(40001)}), {"R-PKT-5"});
  c.invalid("key-127-behind", "A key packet 127 behind is late.", late(),
            main_packets({.tick = 50, .key = true, .sequence = number(1 - 127)}));
  c.invalid("32768-ahead", "A packet 32768 ahead that is not key.", foreign(),
            main_packets({.tick = 50, .sequence = number(1 + 32768)}));
  c.valid("thesis-key-after-outage", "40000 packets are missing before a key packet.",
          thesis_packets({.tick = 50, .key = true, .sequence = number(40001)}), {"R-PKT-5"});
  c.invalid("thesis-32768-ahead", "A packet 32768 ahead that is not key.", foreign(),
            thesis_packets({.tick = 50, .sequence = number(1 + 32768)}));
}

void add_mesh_repeats(Catalogue& c) {
  c.valid("sequence-repeats", "Two kept states have the same sequence; the newest is the baseline.", mesh_sequence_repeats(),
          {"R-PKT-4"});
}

}  // namespace tactus::conformance
