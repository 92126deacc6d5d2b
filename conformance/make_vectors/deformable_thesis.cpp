// SPDX-License-Identifier: Apache-2.0
/// Valid packets of profile thesis.
#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

/// Random vertices and symbols; every fifth packet is lost if `losses`, and the next one builds on the one before it.
Bytes walk(RawDeformable item, std::uint64_t seed, int packets, bool losses = false) {
  item.profile = 0;
  DeformableStream stream(only(item, losses ? 3 : 1));
  Random random(seed);
  const auto vertices = static_cast<std::uint32_t>(item.shape.rest.size());
  std::int64_t tick = 0;
  for (int i = 0; i < packets; ++i) {
    ThesisStep step{.at = {.tick = tick, .key = i % 16 == 0, .baseline = losses && i % 5 == 4 ? 2u : 1u}};
    step.lowest = random.integer(12);
    step.range = random.below(5000);
    const std::uint32_t share = 1 + random.below(255);
    for (std::uint32_t v = random.below(vertices); v < vertices; ++v) {
      if (step.vertices.empty() || random.below(256) < share) {
        ThesisVertex listed{v, {}};
        for (std::uint32_t& s : listed.symbols) s = random.below(1u << item.quant_bits);
        step.vertices.push_back(listed);
      }
    }
    if (losses && i % 5 == 3) stream.lose(step);
    else stream.add(step);
    tick += random.below(40);
  }
  return stream.finished();
}

}  // namespace

void add_deformable_thesis(Catalogue& c) {
  c.section(section::kThesis);
  c.valid("thesis-one-vertex", "Profile thesis: one vertex.", walk({.shape = one_vertex()}, 650, 12));
  c.valid("thesis-sheet", "Profile thesis: 8 bits, initial models in every packet.", walk({.shape = sheet(6, 5)}, 651, 20));
  c.valid("thesis-models-kept", "Profile thesis: models are part of the state; key packets start from the initial ones.",
          walk({.shape = sheet(6, 5), .models_kept = 1}, 652, 40));
  c.valid("thesis-models-lost", "Profile thesis: packets are lost, and models are those of the baseline.",
          walk({.shape = sheet(6, 5), .models_kept = 1}, 653, 30, true));
  c.valid("thesis-1-bit", "Profile thesis: the coarsest quantiser.", walk({.shape = box(3, 2, 2), .quant_bits = 1}, 654, 20));
  c.valid("thesis-12-bits", "Profile thesis: the finest quantiser.",
          walk({.shape = box(3, 2, 2), .quant_bits = 12, .models_kept = 1}, 655, 20));

  DeformableStream gaps(only({.shape = {std::vector<Vec3i>(1100), {}}, .profile = 0}));
  gaps.add(ThesisStep{.at = {.key = true}, .vertices = {{0}, {255, {1, 2, 3}}, {511}, {766}, {767}, {1099, {255, 254, 253}}}});
  gaps.add(ThesisStep{.at = {.tick = 3}, .vertices = {{1099, {9, 9, 9}}}});
  gaps.add(ThesisStep{.at = {.tick = 4}, .vertices = {{254}, {510}, {1021}}});
  c.valid("thesis-gaps", "Profile thesis: gaps of 0, 254, 255, 510 and more.", gaps.finished());

  DeformableStream all(only({.shape = sheet(9, 9), .profile = 0}));
  ThesisStep every{.at = {.key = true}, .lowest = 5, .range = 0};
  for (std::uint32_t v = 0; v < 100; ++v) every.vertices.push_back({v, {v, 0, 255 - v}});
  all.add(every);
  c.valid("thesis-range-0", "Profile thesis: all vertices, a range of 0: symbols say nothing.", all.finished());

  DeformableStream ends(only({.shape = one_triangle(), .profile = 0}));
  for (std::int64_t i = 0; i < 4; ++i)
    ends.add(ThesisStep{.at = {.tick = i, .key = i == 0},
                        .lowest = i < 2 ? -(1 << 28) : 1 << 28,
                        .range = 1u << 29,
                        .vertices = {{0, {0, 128, 255}}, {2, {255, 1, 0}}}});
  c.valid("thesis-saturated", "Profile thesis: the largest errors; displacements stay within +-2^27.", ends.finished());
}

}  // namespace tactus::conformance
