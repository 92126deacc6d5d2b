// SPDX-License-Identifier: Apache-2.0
/// Corrections outside the basis that fade, sets of weights, and steps of modes under tight haptic bounds.
#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr std::uint16_t kTwentieth = 3277;

RawDeformable fading(Shape shape, std::uint16_t fade, std::uint64_t seed) {
  RawDeformable item = with_modes({.shape = std::move(shape)}, 3, seed);
  item.fade = fade;
  return item;
}

/// One vertex and one mode: coefficients and residuals that drive displacement and `off_basis` to both limits.
Bytes to_the_limits() {
  RawDeformable item{.shape = one_vertex(), .fade = kTwentieth, .mode_steps = {65535}};
  item.entries = {2047, -2047, 1023};
  DeformableStream stream(only(item));
  Random random(740);
  const auto any = [&] { return static_cast<std::int32_t>(random.below(3)) - 1; };
  for (std::int64_t tick = 0; tick < 40; ++tick) {
    const std::int32_t push = any(), x = any(), y = any(), z = any();
    stream.add(MainStep{.at = {.tick = tick, .key = tick == 0},
                        .visual = 1u << 26,
                        .coefficients = {push},
                        .residuals = [=](const VertexPrediction&) {
                          return Vec3i{2 * x, 2 * y, z};
                        }});
  }
  return stream.finished();
}

void add_fades(Catalogue& c) {
  c.section(section::kTime);
  c.valid("fade", "Corrections fade by a twentieth per frame; several packets of one tick fade nothing.",
          random_walk(fading(sheet(5, 4), kTwentieth, 741), 741, 40));
  c.valid("fade-least", "fade is 1: small corrections lose a unit per frame, because what is left is rounded towards 0.",
          random_walk(fading(sheet(3, 3), 1, 742), 742, 24));
  c.valid("fade-most", "fade is 65535: nearly nothing is left after a frame.",
          random_walk(fading(sheet(3, 3), 65535, 743), 743, 24));
  c.valid("fade-gaps", "Gaps of up to 15 frames: no more than 8 of them count.",
          random_walk(fading(sheet(3, 3), kTwentieth, 744), 744, 40, 1, 5));
  RawDeformable slow = fading(sheet(3, 3), kTwentieth, 745);
  slow.frame_period = 3 * 256 + 100;
  c.valid("fade-parts-of-frames", "Frames of 3.4 ticks: gaps are rounded to whole ones.", random_walk(slow, 745, 40));
  c.valid("fade-baselines", "Packets on older baselines: frames count from those.",
          random_walk(fading(sheet(3, 3), kTwentieth, 746), 746, 30, 4));
  c.valid("fade-without-basis", "Without a basis the shape itself fades.",
          random_walk({.shape = sheet(3, 3), .fade = kTwentieth}, 747, 24));
  c.valid("fade-limits", "Displacements and what is outside the basis reach both limits.", to_the_limits());
}

void add_sets(Catalogue& c) {
  c.section(section::kWeights);
  c.valid("three-weight-sets", "Every packet names one of three sets of weights.",
          random_walk({.shape = box(4, 3, 2), .weight_sets = 7}, 750, 40));
  c.valid("last-weight-sets", "Sets 1 and 2 are declared; packets count them from 0.",
          random_walk({.shape = sheet(5, 4), .weight_sets = 6}, 751, 30));
  c.valid("only-last-weight-set", "Set 2 alone: packets do not name it.",
          random_walk({.shape = sheet(5, 4), .weight_sets = 4}, 752, 12));
  c.valid("weight-sets-near-one-place", "An object of a few units, where some matrices are not definite with the least nugget.",
          random_walk({.shape = sheet(6, 5, 1), .weight_sets = 7}, 753, 30));
  const Rejection set{"invalid", "R-DEF-14"};
  const auto named = [](std::uint8_t sets, std::uint32_t number) {
    DeformableStream stream(only({.shape = sheet(2, 2), .weight_sets = sets}));
    stream.add(MainStep{.at = {.tick = 10, .key = true}});
    return stream
        .add_packet(11, coded_main_packet(1,
                                          [&](RangeEncoder& coder, MainModels& models) {
                                            coder.bit(models.key, 0);
                                            coder.signed_value(models.late, 0);
                                            coder.bit(models.touched[0], 0);
                                            coder.bit(models.same_visual, 1);
                                            coder.tree<2>(models.density[1], 1);
                                            coder.tree<2>(models.weight_set[0], number);
                                          }))
        .bytes();
  };
  c.invalid("weight-set-2-of-2", "A packet names set 2; two are declared.", set, named(5, 2));
  c.invalid("weight-set-3-of-3", "A packet names set 3; three are declared.", set, named(7, 3));
}

/// The haptic bound rises from 1 to beyond the visual one: the modes' steps follow it between a quarter of that one and all of it.
Bytes reach() {
  DeformableStream stream(only(with_modes({.shape = sheet(3, 3)}, 4, 760)));
  Random random(760);
  for (std::uint32_t i = 0; i < 72; ++i) {
    MainStep step{.at = {.tick = i, .key = i == 0}, .haptic = i, .visual = 1003};
    if (i % 5 != 4) step.triangle = random.below(18);
    for (int k = 0; k < 4; ++k) step.coefficients.push_back(random.integer(4));
    step.residuals = random_residuals(random, 4, 90);
    stream.add(step);
  }
  return stream.finished();
}

void add_declared(Catalogue& c) {
  const Rejection cut{"truncated", "R-STR-5"}, parameter{"invalid", "R-DEF-3"};
  c.section(section::kDeformable);
  c.invalid("cut-fade", "The body ends inside fade.", cut, around({1, 1, 1, 'm', 2, 0, 1, 0, 0, 0, 0}));
  c.invalid("cut-before-weight-sets", "The body ends before weight_sets.", cut, around({1, 1, 1, 'm', 2, 0, 1, 0, 0, 0, 0, 0}));
  c.invalid("weight-sets-0", "weight_sets is 0.", parameter, only({.weight_sets = 0}).bytes());
  c.invalid("weight-sets-8", "weight_sets is 8.", parameter, only({.weight_sets = 8}).bytes());
}

}  // namespace

void add_deformable_fade(Catalogue& c) {
  add_declared(c);
  add_fades(c);
  add_sets(c);
  c.section(section::kVertexBounds);
  c.valid("reach", "Haptic bounds from 0 to beyond the visual one: steps of modes follow them, down to a quarter.", reach());
}

}  // namespace tactus::conformance
