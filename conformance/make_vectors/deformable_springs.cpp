// SPDX-License-Identifier: Apache-2.0
/// Bases that both ends compute.
#include <utility>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

/// Vertices apart from each other, on a bent line, without triangles.
Shape dust(std::size_t vertices) {
  Shape out;
  for (std::size_t v = 0; v < vertices; ++v) {
    const auto i = static_cast<std::int32_t>(v);
    out.rest.push_back({100 * i, i * i % 1000, 7 * i % 300});
  }
  return out;
}

/// Triangles about a centre that has the highest number.
Shape star() {
  Shape out = dust(120);
  for (std::uint32_t v = 0; v + 2 < 120; v += 2) out.triangles.push_back({v, v + 1, 119});
  return out;
}

void add_valid(Catalogue& c) {
  c.section(section::kComputedBasis);
  c.valid("spring-modes", "A closed box, four corners fixed: modes in every packet.",
          random_walk({.shape = box(4, 3, 1), .spring_modes = 8, .runs = {{0, 0}, {3, 0}, {10, 1}}}, 760, 12, 4), {"R-DEF-7"});
  c.valid("spring-modes-of-a-sheet",
          "Flat, two stages, fixed vertices beyond the first one; springs alone would leave its normal free.",
          random_walk({.shape = sheet(7, 6, 9000), .spring_modes = 5, .runs = {{1, 0}, {9, 0}, {8, 0}, {20, 0}}}, 761, 6));
  c.valid("spring-modes-all", "As many modes as free components.",
          random_walk({.shape = one_triangle(), .spring_modes = 6, .runs = {{1, 0}}}, 762, 4));
  c.valid("spring-modes-of-one-vertex", "No spring at all.", random_walk({.shape = one_vertex(), .spring_modes = 3}, 763, 3));
  c.valid("spring-modes-of-copies", "Vertices at one place are no springs' ends.",
          random_walk({.shape = both(sheet(2, 2), sheet(2, 2)), .spring_modes = 4, .runs = {{2, 0}}}, 764, 4));
  c.valid("spring-modes-beyond-the-core", "Every vertex is a root, and the first 1024 are fixed: the modes are 0.",
          random_walk({.shape = dust(1030), .spring_modes = 2, .runs = {{0, 1023}}}, 765, 2));
  c.valid("spring-modes-of-far-vertices", "Rest positions at both ends of 32 bits.",
          random_walk({.shape = {{{-2147483647 - 1, 0, 5}, {2147483647, -2147483647 - 1, 0}, {0, 2147483647, 0}, {1, 2, 3}},
                                 {{0, 1, 2}, {1, 2, 3}}},
                       .spring_modes = 3,
                       .runs = {{3, 0}}},
                      766, 3));
  constexpr std::uint16_t kFade = 4217;  // 98 % per second at 60 frames/s
  for (const std::uint8_t sets : {std::uint8_t{2}, std::uint8_t{4}, std::uint8_t{6}})
    c.valid("spring-modes-weight-sets-" + std::to_string(sets),
            "Modes are computed with weight set 0, though packets may not name it; what is outside the basis fades.",
            random_walk({.shape = box(4, 3, 1), .fade = kFade, .weight_sets = sets, .spring_modes = 8, .runs = {{0, 0}, {13, 1}}},
                        767u + sets, 16, 4));
  c.valid("spring-modes-in-layers", "Both layers of an object with a computed basis that fades.",
          random_walk({.shape = sheet(5, 4), .layered = 1, .fade = kFade, .weight_sets = 7, .spring_modes = 6, .runs = {{0, 3}}},
                      774, 24, 3));
  c.valid("spring-modes-of-a-star", "Depths that lose one vertex each: few of them have a network of their own.",
          random_walk({.shape = star(), .spring_modes = 1, .runs = {{5, 0}}}, 775, 2));
}

void add_faults(Catalogue& c) {
  const Rejection cut{"truncated", "R-STR-5"}, overlong{"malformed", "R-STR-5"}, basis{"invalid", "R-DEF-7"};
  const auto with = [](const Bytes& bytes) { return only({.basis = bytes}).bytes(); };  // one triangle
  c.section(section::kDeformable);
  c.invalid("basis-4", "basis is 4.", {"malformed", "R-DEF-7"}, with({4, 1, 0}));
  c.invalid("no-basis", "The body ends before basis.", cut, with({}));
  c.invalid("basis-without-modes", "The body ends before mode_count.", cut, with({2}));
  c.invalid("declared-mode-count-0", "A declared basis of no mode.", basis, with({1, 0}));
  c.invalid("computed-mode-count-0", "A computed basis of no mode.", basis, with({2, 0, 0}));
  c.invalid("computed-mode-count-65", "A computed basis of 65 modes.", basis,
            only({.shape = sheet(5, 5), .basis = Bytes{2, 65, 0}}).bytes());
  c.invalid("no-run-count", "The body ends before run_count.", cut, with({2, 1}));
  c.invalid("no-room-for-runs", "One byte too few for two runs.", cut, with({2, 1, 2, 0, 0, 1}));
  c.invalid("overlong-gap", "gap 0 is written in two bytes.", overlong, with({2, 1, 1, 0x80, 0x00, 0}));
  c.invalid("cut-run", "The body ends inside more.", cut, with({2, 1, 1, 0, 0x80}));
  c.invalid("run-without-gap", "The second run touches the first.", basis, with({2, 1, 2, 0, 0, 0, 0}));
  c.invalid("run-of-no-vertex", "A run begins at vertex 3 of 3.", basis, with({2, 1, 1, 3, 0}));
  c.invalid("run-too-long", "A run ends at vertex 3 of 3.", basis, with({2, 1, 1, 1, 2}));
  c.invalid("second-run-too-long", "The second run ends at vertex 3 of 3.", basis, with({2, 1, 2, 0, 0, 1, 1}));
  c.invalid("gap-of-64-bits", "gap is 2^64 - 1: in 64-bit arithmetic the run would end at vertex 0.", basis,
            with(Bytes{2, 1, 1} + varint(~std::uint64_t{0}) + Bytes{1}));
  c.invalid("more-modes-than-components", "7 modes; 2 of 3 vertices are free.", basis, with({2, 7, 1, 0, 0}));
  c.invalid("all-vertices-fixed", "1 mode; no vertex is free.", basis, with({2, 1, 1, 0, 2}));
  c.invalid("run-before-cut", "A run begins at vertex 3 of 3, and the next one is cut.", {"invalid", "R-DEF-7", "R-STR-5"},
            with({2, 1, 2, 3, 0, 0x80, 0x80}));
  c.invalid("runs-before-modes", "7 modes for 2 free vertices; the second run is of no vertex.", basis,
            with({2, 7, 2, 0, 0, 2, 0}));
}

/// 64 modes of so many vertices in one place.
Input work_of(std::size_t vertices) {
  RawDeformable item{.shape = {std::vector<Vec3i>(vertices), {}}, .spring_modes = 64};
  RawHeader header = only(item);
  Bytes all = header.bytes();
  const std::size_t zeros = 3 * vertices, end = all.size() - 4 - 3;  // crc; basis, mode_count and run_count
  return {std::move(all), {end - zeros, {0}, zeros}};
}

void add_limits(Catalogue& c) {
  c.section(section::kLimits);
  c.invalid("basis-work", "64 modes of 40575 vertices: work of 2^22 + 56.", {"limit_exceeded", "R-STR-21"}, work_of(40575));
  RawHeader header;
  header.objects.clear();
  std::vector<RawDeformable> items(4, {.shape = dust(1024), .spring_modes = 64});
  for (std::size_t i = 0; i < items.size(); ++i) items[i].name = std::to_string(i);
  c.invalid("basis-work-of-all", "Four objects, each of 64 modes and 1024 vertices.", {"limit_exceeded", "R-STR-21"},
            with_deformables(header, items).bytes());
  header.baseline_span = 64;
  items.assign(1, {.shape = {std::vector<Vec3i>(345000), {}}, .spring_modes = 64});
  Bytes large = with_deformables(header, items).bytes();
  c.invalid("states-before-basis-work", "Too large states, and too much work.", {"limit_exceeded", "R-STR-18", "R-STR-21"},
            [&]() -> Input {
              const std::size_t zeros = std::size_t{3} * 345000, end = large.size() - 7;
              return {std::move(large), {end - zeros, {0}, zeros}};
            }());
}

}  // namespace

void add_deformable_springs(Catalogue& c) {
  add_valid(c);
  add_faults(c);
  add_limits(c);
}

}  // namespace tactus::conformance
