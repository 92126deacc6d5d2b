// SPDX-License-Identifier: Apache-2.0
/// What packets of every kind have in common, shown by those of deformable objects: ticks, sequence numbers, baselines, outages.
#include <utility>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

Rejection no_baseline() { return {"state", "R-PKT-4"}; }
Rejection late() { return {"state", "R-PKT-5"}; }
Rejection far_ahead() { return {"state", "R-PKT-7"}; }

constexpr std::uint16_t number(std::int32_t sequence) { return static_cast<std::uint16_t>(sequence); }

RawDeformable sheet_of(std::uint8_t profile) { return {.shape = sheet(2, 2), .profile = profile, .quant_bits = 4}; }

/// Packets 0 and 1 at ticks 10 and 30, then one more.
template <class Step>
Bytes packets(std::uint8_t profile, const Step& first, const Step& second, const Step& third) {
  DeformableStream stream(only(sheet_of(profile)));
  return stream.add(first).add(second).add(third).bytes();
}

Bytes main_packets(const PacketPlace& third) {
  return packets(1, MainStep{.at = {.tick = 10, .key = true}}, MainStep{.at = {.tick = 30}}, MainStep{.at = third});
}

Bytes thesis_packets(const PacketPlace& third) {
  const std::vector<ThesisVertex> vertices{{4, {1, 2, 3}}};
  return packets(0, ThesisStep{.at = {.tick = 10, .key = true}, .vertices = vertices},
                 ThesisStep{.at = {.tick = 30}, .vertices = vertices}, ThesisStep{.at = third, .vertices = vertices});
}

/// Sequences 5 to 10 come twice within the 64 states that are kept.
Bytes sequence_repeats() {
  DeformableStream stream(only(sheet_of(1), 64));
  Random random(740);
  std::int64_t tick = 0;
  for (const std::int32_t start : {5, 32772, 65539}) {
    for (std::int32_t i = 0; i < 7; ++i)
      stream.add(MainStep{.at = {.tick = ++tick, .key = i == 0, .sequence = number(start + i)},
                          .residuals = random_residuals(random, 5, 200)});
  }
  return stream.finished();
}

void add_baselines(Catalogue& c) {
  DeformableStream keys(only({.shape = sheet(4, 3)}));
  Random random(630);
  for (std::int64_t i = 0; i < 9; ++i)
    keys.add(MainStep{.at = {.tick = 10 * i, .key = i % 4 == 0},
                      .triangle = static_cast<std::uint32_t>(i),
                      .haptic = 40,
                      .residuals = random_residuals(random, 5, 100)});
  c.section(section::kBaselines);
  c.valid("main-key-packets", "Key packets in the middle: everything returns to the initial state first.", keys.finished());

  DeformableStream losses(only(with_modes({.shape = sheet(4, 3)}, 3, 631), 4));
  for (std::int64_t i = 0; i < 16; ++i) {
    const bool lost = i % 5 == 3, after_loss = i % 5 == 4;
    const MainStep step{.at = {.tick = i, .key = i == 0, .baseline = after_loss ? 2u : 1u},
                        .coefficients = {random.integer(5), random.integer(5), 1},
                        .residuals = random_residuals(random, 5, 60)};
    if (lost) losses.lose(step);
    else losses.add(step);
  }
  c.valid("main-older-baselines", "Every fifth packet is lost; the next one builds on the one before it.", losses.finished());
  c.valid("main-random-baselines", "Packets that build on any of the 64 before.",
          random_walk(with_modes({.shape = sheet(3, 2)}, 2, 632), 632, 90, 64));

  DeformableStream wrap(only({.shape = sheet(2, 2)}, 2));
  for (std::int64_t i = 0; i < 6; ++i) {
    MainStep step{.at = {.tick = i, .key = i == 0, .baseline = 1}, .residuals = random_residuals(random, 5, 100)};
    if (i == 0) step.at.sequence = std::uint16_t{65533};
    wrap.add(step);
  }
  c.section(section::kNumbers);
  c.valid("main-sequence-wrap", "The sequence passes 65535.", wrap.finished());

  DeformableStream ticks(only({.shape = one_triangle(), .frame_period = 4267}));
  std::int64_t tick = 0;
  for (const std::int64_t delta : {0ll, 17ll, 16ll, 0ll, 1ll, 33ll, 5000ll, 70000ll, 2000000000ll}) {
    tick += delta;
    ticks.add(MainStep{.at = {.tick = tick, .key = tick == 0}, .residuals = random_residuals(random, 4, 200)});
  }
  c.section(section::kBaselines);
  c.valid("main-late-and-early", "Packets at the same tick, early, in time and late by up to 31 bits.", ticks.finished());
  DeformableStream clamped(only({.shape = one_triangle(), .frame_period = 4267}));
  clamped.add(MainStep{.at = {.tick = 50, .key = true}});
  clamped.add_packet(50, coded_main_packet(1, [&](RangeEncoder& coder, MainModels& models) {
                       coder.bit(models.key, 0);
                       coder.signed_value(models.late, -1000);
                       coder.bit(models.touched[0], 0);
                       coder.bit(models.same_visual, 1);
                       coder.tree<2>(models.density[1], 0);
                       for (int v = 0; v < 3; ++v) coder.bit(models.significant[0][0][0][v == 0 ? 1 : 0], 0);
                     }));
  c.valid("main-earlier-than-the-baseline", "late says 983 ticks before the baseline: the tick is the baseline's.",
          clamped.finished());
  c.section(section::kNumbers);
  c.valid("main-sequence-repeats", "Two kept states have the same sequence; the newest is the baseline.", sequence_repeats(),
          {"R-PKT-4"});
}

void add_main_rules(Catalogue& c) {
  c.invalid("main-packet-of-0-bytes", "A packet without a byte.", {"truncated", "R-PKT-2"}, then_packet(two_main_packets(), {}));
  c.invalid("main-packet-of-1-byte", "A packet of half a sequence number.", {"truncated", "R-PKT-2"},
            then_packet(two_main_packets(), {2}));
  c.invalid("main-baseline-delta-0", "baseline_delta is 0.", {"invalid", "R-PKT-3"},
            then(two_main_packets(4), MainStep{.at = {.tick = 31, .baseline = 0}}));
  c.invalid("main-baseline-delta-5", "baseline_delta is 5; baseline_span is 4.", {"invalid", "R-PKT-3"},
            then(two_main_packets(4), MainStep{.at = {.tick = 31, .baseline = 5}}));
  c.invalid("main-first-is-not-key", "The first packet builds on a packet before it.", no_baseline(),
            DeformableStream(main_scene()).add(MainStep{.at = {.tick = 1}}).bytes());
  c.invalid("main-lost-baseline", "A packet is missing; the next one builds on it.", no_baseline(),
            then(two_main_packets(), MainStep{.at = {.tick = 31, .sequence = std::uint16_t{3}}}));
  c.invalid("main-repeated-packet", "A packet with the sequence number of the one before.", late(),
            then(two_main_packets(), MainStep{.at = {.tick = 31, .key = true, .sequence = std::uint16_t{1}}}));
  c.valid("main-half-the-circle", "A key packet 32768 ahead begins anew.",
          then(two_main_packets(), MainStep{.at = {.tick = 31, .key = true, .sequence = std::uint16_t{32769}}}), {"R-PKT-5"});
  c.invalid("main-late-before-all", "A late packet whose payload breaks R-RNG-4.", {"state", "R-PKT-5", "R-RNG-4"},
            then_packet(two_main_packets(), {1, 0, 0xff, 0xff, 0xff, 0xff}));
  c.invalid(
      "main-tick-mismatch", "The record says tick 30, the packet 31.", {"invalid", "R-FIL-7"},
      then_packet(two_main_packets(), DeformableStream(two_main_packets()).composer().packet(MainStep{.at = {.tick = 31}})));
  c.invalid("main-key-in-the-past", "A key packet at tick 29, after tick 30, begins anew; the record cannot say so.",
            {"invalid", "R-FIL-7"},
            then_packet(two_main_packets(), two_main_packets().composer().packet(MainStep{.at = {.tick = 29, .key = true}})));
}

void add_thesis_rules(Catalogue& c) {
  c.invalid("thesis-baseline-delta-5", "baseline_delta is 5; baseline_span is 4.", {"invalid", "R-PKT-3"},
            then(two_thesis_packets(4), ThesisStep{.at = {.tick = 31, .baseline = 5}, .vertices = {{0}}}));
  c.invalid("thesis-lost-baseline", "A packet is missing; the next one builds on it.", {"state", "R-PKT-4"},
            then(two_thesis_packets(), ThesisStep{.at = {.tick = 31, .sequence = std::uint16_t{3}}, .vertices = {{0}}}));
  c.invalid(
      "thesis-late-packet", "A packet older than the current state.", {"state", "R-PKT-5"},
      then(two_thesis_packets(), ThesisStep{.at = {.tick = 31, .key = true, .sequence = std::uint16_t{0}}, .vertices = {{0}}}));
  c.invalid(
      "thesis-key-in-the-past", "A key packet at tick 0, after tick 30, begins anew; the record cannot say so.",
      {"invalid", "R-FIL-7"},
      then_packet(two_thesis_packets(),
                  RawThesis{.sequence = 2, .list = thesis_symbols({0}, 8), .errors = thesis_symbols({3, 4, 5}, 4)}.bytes()));
}

void add_outages(Catalogue& c) {
  c.valid("main-key-after-outage", "40000 packets are missing before a key packet.",
          main_packets({.tick = 50, .key = true, .sequence = number(40001)}), {"R-PKT-5"});
  DeformableStream key = two_main_packets(4);
  key.add(MainStep{.at = {.tick = 30, .key = true}}).add(MainStep{.at = {.tick = 31, .baseline = 2}});
  c.valid("main-key-at-the-same-tick",
          "A key packet at the current tick does not begin anew: what was before it may be a baseline.", key.finished(),
          {"R-PKT-4"});
  DeformableStream thesis_key = two_thesis_packets(4);
  thesis_key.add(ThesisStep{.at = {.tick = 30, .key = true}, .vertices = {{3}}});
  thesis_key.add(ThesisStep{.at = {.tick = 31, .baseline = 2}, .vertices = {{5}}});
  c.valid("thesis-key-at-the-same-tick", "The same of profile thesis.", thesis_key.finished(), {"R-PKT-4"});
  c.invalid("main-key-127-behind", "A key packet 127 behind is late.", late(),
            main_packets({.tick = 50, .key = true, .sequence = number(1 - 127)}));
  c.invalid("main-32767-ahead", "A packet 32767 ahead that is not key: its baseline is missing.", no_baseline(),
            main_packets({.tick = 50, .sequence = number(1 + 32767)}));
  c.invalid("main-32768-ahead", "A packet 32768 ahead that is not key.", far_ahead(),
            main_packets({.tick = 50, .sequence = number(1 + 32768)}));
  c.valid("thesis-key-after-outage", "40000 packets are missing before a key packet.",
          thesis_packets({.tick = 50, .key = true, .sequence = number(40001)}), {"R-PKT-5"});
  c.invalid("thesis-32768-ahead", "A packet 32768 ahead that is not key.", far_ahead(),
            thesis_packets({.tick = 50, .sequence = number(1 + 32768)}));
}

/// Two faults at once: the one that is read first counts.
void add_orders(Catalogue& c) {
  DeformableStream stream(only({.shape = sheet(2, 2)}, 4));
  stream.add(MainStep{.at = {.tick = 10, .key = true}}).add(MainStep{.at = {.tick = 30}});
  c.invalid("main-late-before-baseline-delta", "A late packet whose baseline_delta has 33 bits.", {"state", "R-PKT-5", "R-RNG-4"},
            then_packet(two_main_packets(4), coded_main_packet(1, [](RangeEncoder& coder, MainModels& models) {
                          coder.bit(models.key, 0);
                          coder.tree<4>(models.baseline, 15);
                          coder.raw(5, 18);
                        })));
  c.invalid("main-baseline-delta-before-ahead", "baseline_delta is 0, and the packet 32768 ahead.",
            {"invalid", "R-PKT-3", "R-PKT-7"},
            then_packet(std::move(stream), coded_main_packet(32769, [](RangeEncoder& coder, MainModels& models) {
                          coder.bit(models.key, 0);
                          coder.magnitude(models.baseline, 0);
                          coder.signed_value(models.late, 0);
                        })));
  DeformableStream thesis(only({.shape = sheet(2, 2), .profile = 0, .quant_bits = 4}, 4));
  thesis.add(ThesisStep{.at = {.tick = 10, .key = true}, .vertices = {{0}}});
  thesis.add(ThesisStep{.at = {.tick = 30}, .vertices = {{8}}});
  c.invalid("thesis-late-before-cut", "A late packet of a sequence number and nothing more.", {"state", "R-PKT-5", "R-DEF-11"},
            then_packet(std::move(thesis), {1, 0}));
}

}  // namespace

void add_packet_deformable(Catalogue& c) {
  add_baselines(c);
  add_main_rules(c);
  add_thesis_rules(c);
  add_outages(c);
  add_orders(c);
}

}  // namespace tactus::conformance
