// SPDX-License-Identifier: Apache-2.0
/// What packets of every kind have in common, shown by rigid ones: sequence numbers, baselines, outages.
#include <algorithm>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

Rejection no_baseline() { return {"state", "R-PKT-4"}; }
Rejection late() { return {"state", "R-PKT-5"}; }
Rejection far_ahead() { return {"state", "R-PKT-7"}; }

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

/// A key packet at the tick of the one before it, then one that builds on that one.
Bytes key_at_the_same_tick() {
  Stream stream = two_packets(4);
  stream.add({.tick = 30, .updates = moved(7), .key = true});
  stream.add({.tick = 31, .updates = moved(8), .baseline = 2});
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

RawHeader chained(std::uint8_t span, std::vector<RawObject> objects) {
  RawHeader header{.objects = std::move(objects)};
  header.baseline_span = span;
  return header;
}

/// Packets 3 and 7 never arrive; every packet builds on one that did.
Bytes older_baselines() {
  Stream stream(chained(4, {{"a"}, {"b"}}));
  Random random(406);
  const auto add = [&](std::uint16_t sequence, std::int64_t tick, std::uint32_t baseline, std::uint32_t object) {
    stream.add(
        {.tick = tick, .updates = {random_update(random, stream.header(), object)}, .baseline = baseline, .sequence = sequence});
  };
  stream.add({.tick = 5,
              .updates = {random_update(random, stream.header(), 0), random_update(random, stream.header(), 1)},
              .key = true});
  add(1, 10, 1, 0);
  add(2, 20, 2, 1);
  add(4, 30, 2, 0);
  add(5, 40, 4, 1);
  add(6, 40, 4, 0);
  add(8, 55, 4, 1);
  add(9, 60, 1, 0);
  return stream.finish().bytes();
}

Bytes random_baselines() {
  RawHeader header =
      chained(64, {{"a"}, {"fixed", Dof::none}, {"b", Dof::translation}, {"c", Dof::rz}, {"d", Dof::all, {7, 7, 7}}});
  Stream stream(header);
  Random random(407);
  std::int64_t tick = 0;
  for (std::uint32_t i = 0; i < 250; ++i) {
    Step step{.tick = tick, .updates = {}, .key = i % 50 == 0, .baseline = 1 + random.below(std::min(i, 64u) + (i == 0 ? 1 : 0))};
    for (const std::uint32_t object : {0u, 2u, 3u, 4u}) {
      if (random.below(3) == 0) step.updates.push_back(random_update(random, stream.header(), object));
    }
    if (step.updates.empty()) step.updates.push_back(random_update(random, stream.header(), 2));
    stream.add(step);
    tick += random.below(30);
  }
  return stream.finish().bytes();
}

Bytes sequence_wrap() {
  Stream stream(chained(2, {{"x", Dof::x}}));
  const auto update = [](std::int32_t by) { return std::vector<Update>{{0, Reason::visual, 0, {{{by, 0, 0}, {by, 0, 0}}}}}; };
  stream.add({.tick = 1, .updates = update(1), .key = true, .sequence = std::uint16_t{65533}});
  for (int i = 2; i < 7; ++i) stream.add({.tick = i, .updates = update(i), .baseline = i == 2 ? 1u : 2u});
  stream.add({.tick = 9, .updates = update(50), .key = true, .sequence = static_cast<std::uint16_t>(2 + 32767)});
  stream.add({.tick = 10, .updates = update(51)});
  return stream.finish().bytes();
}

/// Sequences 5 to 10 come twice within the 64 states that are kept.
Bytes sequence_repeats() {
  Stream stream(chained(64, {{"x", Dof::x}}));
  std::int64_t tick = 0;
  const auto add = [&](std::optional<std::uint16_t> sequence) {
    const std::int32_t by = static_cast<std::int32_t>(++tick);
    const std::vector<Update> updates{{0, Reason::visual, 0, {{{by, 0, 0}, {by, 0, 0}}}}};
    stream.add({.tick = tick, .updates = updates, .key = sequence.has_value(), .sequence = sequence});
  };
  for (const int start : {5, 32772, 65539}) {
    add(static_cast<std::uint16_t>(start));
    for (int i = 0; i < 6; ++i) add(std::nullopt);
  }
  return stream.finish().bytes();
}

void add_baselines(Catalogue& c) {
  c.section(section::kBaselines);
  c.valid("rigid-older-baselines", "Packets 3 and 7 are lost; each packet builds on one that arrived, up to 4 back.",
          older_baselines(), {"R-PKT-3", "R-PKT-4", "R-PKT-5"});
  c.valid("rigid-random-baselines", "250 packets that build on any of the 64 before.", random_baselines(),
          {"R-PKT-3", "R-PKT-4"});
  c.section(section::kNumbers);
  c.valid("rigid-sequence-wrap", "The sequence passes 65535, then jumps by 32767.", sequence_wrap(), {"R-PKT-5"});
  c.valid("rigid-sequence-repeats", "Two kept states have the same sequence; the newest is the baseline.", sequence_repeats(),
          {"R-PKT-4"});
}

/// Packets 100 and 101 of three objects, the second one static, at ticks 10 and 30.
RawHeader three_objects(std::uint8_t span = 1) {
  RawHeader header;
  header.baseline_span = span;
  header.objects = {{"a"}, {"wall", Dof::none}, {"b"}};
  return header;
}

Stream two_of_three_objects(std::uint8_t span = 1) {
  Stream stream(three_objects(span));
  stream.add({.tick = 10, .updates = moved(4), .key = true, .sequence = number(100)});
  stream.add({.tick = 30, .updates = moved(5)});
  return stream;
}

Bytes then(Stream stream, const Step& step) { return stream.add(step).bytes(); }

void add_rules(Catalogue& c) {
  c.invalid("rigid-packet-of-0-bytes", "A packet without a byte.", {"truncated", "R-PKT-2"},
            two_of_three_objects().add_packet(30, {}).bytes());
  c.invalid("rigid-packet-of-1-byte", "A packet of half a sequence number.", {"truncated", "R-PKT-2"},
            two_of_three_objects().add_packet(30, {102}).bytes());
  c.invalid("rigid-baseline-delta-0", "baseline_delta is 0.", {"invalid", "R-PKT-3"},
            then(two_of_three_objects(4), {.tick = 30, .updates = moved(1), .baseline = 0}));
  c.invalid("rigid-baseline-delta-5", "baseline_delta is 5; baseline_span is 4.", {"invalid", "R-PKT-3"},
            then(two_of_three_objects(4), {.tick = 30, .updates = moved(1), .baseline = 5}));
  c.invalid("rigid-first-is-not-key", "The first packet builds on a packet before it.", no_baseline(),
            Stream(three_objects()).add({.tick = 1, .updates = moved(1)}).bytes());
  c.invalid("rigid-lost-baseline", "A packet is missing; the next one builds on it.", no_baseline(),
            then(two_of_three_objects(), {.tick = 31, .updates = moved(1), .sequence = number(103)}));
  c.invalid("rigid-baseline-before-first", "The baseline lies before the first packet.", no_baseline(),
            then(two_of_three_objects(4), {.tick = 31, .updates = moved(1), .baseline = 3}));
  Stream gap = two_of_three_objects(4);
  gap.add({.tick = 40, .updates = moved(6), .baseline = 2, .sequence = number(103)});
  c.invalid("rigid-baseline-never-received", "The baseline is a lost packet between two that were decoded.", no_baseline(),
            then(gap, {.tick = 41, .updates = moved(1), .baseline = 2}));
  c.invalid("rigid-repeated-packet", "A packet with the sequence number of the one before.", late(),
            then(two_of_three_objects(), {.tick = 30, .updates = moved(1), .key = true, .sequence = number(101)}));
  c.invalid("rigid-late-packet", "A packet one older than the current state.", late(),
            then(two_of_three_objects(), {.tick = 30, .updates = moved(1), .key = true, .sequence = number(100)}));
  c.valid("rigid-half-the-circle", "A key packet 32768 ahead begins anew.",
          then(two_of_three_objects(), {.tick = 30, .updates = moved(1), .key = true, .sequence = number(101 + 32768)}),
          {"R-PKT-5"});
  c.invalid("rigid-key-in-the-past", "A key packet at tick 29, after tick 30, begins anew; the record cannot say so.",
            {"invalid", "R-FIL-7"},
            two_of_three_objects()
                .add_packet(30, raw_packet(*three_objects().parsed(), 102, {{true, 1, 29}, 1}, std::vector<RawUpdate>(1)))
                .bytes());
}

void add_outages(Catalogue& c) {
  c.valid("rigid-key-after-outage", "40000 packets are missing before a key packet; the next builds on it.",
          with_key(101 + 40000), {"R-PKT-4", "R-PKT-5"});
  c.valid("rigid-key-at-the-same-tick",
          "A key packet at the current tick does not begin anew: what was before it may be a baseline.", key_at_the_same_tick(),
          {"R-PKT-4"});
  c.valid("rigid-key-128-behind", "A key packet 128 behind begins anew.", with_key(101 - 128), {"R-PKT-5"});
  c.invalid("rigid-key-127-behind", "A key packet 127 behind is late.", late(), with_key(101 - 127));
  c.invalid("rigid-32767-ahead", "A packet 32767 ahead that is not key: its baseline is missing.", no_baseline(),
            two_packets().add({.tick = 50, .updates = moved(1), .sequence = number(101 + 32767)}).bytes());
  c.invalid("rigid-32768-ahead", "A packet 32768 ahead that is not key.", far_ahead(),
            two_packets().add({.tick = 50, .updates = moved(1), .sequence = number(101 + 32768)}).bytes());
  c.invalid("rigid-128-behind", "A packet 128 behind that is not key.", far_ahead(),
            two_packets().add({.tick = 50, .updates = moved(1), .sequence = number(101 - 128)}).bytes());
  c.invalid("rigid-round-the-numbers", "The baseline's sequence is that of a kept state 65536 packets ago.", no_baseline(),
            round_the_numbers());
  c.invalid("rigid-begun-anew-forgets", "A key packet begins anew; the next one builds on a state before it.", no_baseline(),
            forgotten());
  c.invalid("rigid-65536-missing", "65536 packets are missing: numbers fit, the tick is 70000 too early.", {"invalid", "R-FIL-7"},
            two_packets().add_packet(70030, two_packets().packet({.tick = 31, .updates = moved(1)})).bytes());
}

/// Packets 0 and 1 of two objects at ticks 10 and 30, then any packet.
Bytes of_two_objects(const Bytes& packet) {
  Stream stream(chained(4, {{"a"}, {"b"}}));
  stream.add({.tick = 10, .key = true});
  stream.add({.tick = 30});
  return stream.add_packet(30, packet).bytes();
}

void add_orders(Catalogue& c) {
  c.invalid("rigid-late-before-all", "A late packet whose payload breaks R-RNG-4.", {"state", "R-PKT-5", "R-RNG-4"},
            of_two_objects({1, 0, 0xff, 0xff, 0xff, 0xff}));
  c.invalid("rigid-late-before-baseline-delta", "A late packet whose baseline_delta has 33 bits.",
            {"state", "R-PKT-5", "R-RNG-4"}, of_two_objects(coded_packet(1, [](RangeEncoder& coder, RigidModels& models) {
              coder.bit(models.key, 0);
              coder.tree<4>(models.baseline, 15);
              coder.raw(5, 18);
            })));
  c.invalid(
      "rigid-baseline-delta-before-ahead", "baseline_delta is 0, and the packet 32768 ahead.", {"invalid", "R-PKT-3", "R-PKT-7"},
      of_two_objects(raw_packet(*chained(4, {{"a"}, {"b"}}).parsed(), 32769, {{false, 0, 0}, 1}, std::vector<RawUpdate>(1))));
}

/// The packets 100 and 101, then a record of a packet: sequence, zeros and a last byte of 1.
Input then_zeros(std::size_t packet_size) {
  const Bytes head = two_packets().bytes();
  const Bytes last = record(1, varint(0) + Bytes{102, 0} + Bytes(packet_size - 3, 0) + Bytes{1});
  return {head + last, {head.size() + 20, {0}, packet_size - 40}};
}

void add_lengths(Catalogue& c) {
  c.invalid("rigid-longest-packet", "A packet of 2^20 bytes, as many as a decoder must take: most are left over.",
            {"malformed", "R-RNG-2"}, then_zeros(1 << 20));
  c.invalid("rigid-packet-too-long", "A packet of 2^20 + 1 bytes.", {"limit_exceeded", "R-PKT-1"}, then_zeros((1 << 20) + 1));
}

}  // namespace

void add_packet_rigid(Catalogue& c) {
  add_baselines(c);
  add_rules(c);
  add_outages(c);
  add_lengths(c);
  add_orders(c);
}

}  // namespace tactus::conformance
