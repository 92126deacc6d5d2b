// SPDX-License-Identifier: Apache-2.0
/// Valid packets of profile main.
#include <algorithm>
#include <limits>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr std::int32_t kWidest = std::numeric_limits<std::int32_t>::max();

void add_shapes(Catalogue& c) {
  c.section(section::kCodingOrder);
  c.valid("one-vertex", "One vertex and no triangle.", random_walk({.shape = one_vertex()}, 600, 20));
  c.valid("one-triangle", "One triangle: its number takes no bit.", random_walk({.shape = one_triangle()}, 601, 20));
  c.valid("no-triangles", "Nine vertices without a triangle: all are roots.",
          random_walk({.shape = {sheet(2, 2).rest, {}}}, 602, 12));
  c.valid("open", "An open sheet.", random_walk({.shape = sheet(6, 5)}, 603, 16));
  c.valid("closed", "A closed box.", random_walk({.shape = box(4, 3, 2)}, 604, 16));
  c.valid("components", "Two components and a vertex of its own.",
          random_walk({.shape = both(both(sheet(3, 2), one_vertex()), moved(box(2, 2, 1), {0, 0, 50000}))}, 605, 16));
  Shape mirror = sheet(4, 3);
  for (Vec3i& p : mirror.rest) p[0] = -p[0];
  mirror = both(both(sheet(4, 3), mirror), moved(one_vertex(), {-7, 8, -9}));
  c.valid("seams", "Two sheets side by side: vertices in one place are copies of each other, three of them at a corner.",
          random_walk({.shape = mirror}, 612, 16));
  c.valid("slivers", "Triangles a thousand times longer than wide.", random_walk({.shape = slivers(60)}, 606, 12));
  Shape one_place = sheet(4, 3);
  for (Vec3i& p : one_place.rest) p = {5, 5, 5};
  c.valid("one-place", "All vertices in one place: every distance is 1.", random_walk({.shape = one_place}, 607, 12));
  Shape mirrored = sheet(5, 4, 200001);
  for (Vec3i& p : mirrored.rest) p[0] = -p[0];
  c.valid("shifted-distances", "So large that distances are shifted, with differences of both signs.",
          random_walk({.shape = mirrored}, 608, 12));
  Shape wide = sheet(3, 3, 1);
  for (std::size_t i = 0; i < wide.rest.size(); ++i)
    wide.rest[i] = {i % 2 == 0 ? kWidest : -kWidest - 1, static_cast<std::int32_t>(i), i % 3 == 0 ? -kWidest - 1 : kWidest};
  c.valid("ends-of-the-grid", "Rest positions at both ends of 32 bits.", random_walk({.shape = wide}, 609, 8));
  c.section(section::kParents);
  c.valid("fan", "A hundred triangles around one vertex: more than 64 visits in search of parents.",
          random_walk({.shape = flat_fan(100)}, 610, 8));
  Shape duplicates = sheet(3, 3);
  duplicates.triangles.insert(duplicates.triangles.end(), {duplicates.triangles[0], {0, 4, 8}, {8, 4, 0}});
  c.section(section::kCodingOrder);
  c.valid("not-a-surface", "A triangle twice, one both ways round, edges with four triangles.",
          random_walk({.shape = duplicates}, 611, 12));
}

/// A press that moves over the membrane: displacement of vertex v at a tick.
Vec3i pressed(const Shape& shape, std::uint32_t v, std::int64_t tick) {
  const std::int64_t x = shape.rest[v][0] - (8000 + 300 * tick), y = shape.rest[v][1] - 34000;
  const std::int64_t d = (x * x + y * y) >> 16;
  return {0, 0, static_cast<std::int32_t>(-400000 / (40 + d))};
}

Bytes membrane() {
  const RawDeformable item{.shape = box(16, 18, 2), .rings = 3, .frame_period = 16 * 256 + 171};
  DeformableStream stream(only(item));
  for (std::int64_t i = 0; i < 8; ++i) {
    const std::int64_t tick = (50 * i + 1) / 3;
    const auto target = [&](std::uint32_t v) { return pressed(item.shape, v, tick); };
    stream.add(MainStep{.at = {.tick = tick, .key = i == 0},
                        .triangle = static_cast<std::uint32_t>(4 * (200 + 9 * i) % 1424),
                        .haptic = 34,
                        .visual = 209,
                        .density = 1,
                        .residuals = towards(target)});
  }
  return stream.finished();
}

Bytes level_23() {
  // In every graph only the middle of the fan joins a neighbour, so that each level holds one vertex and 24 levels do not suffice.
  return random_walk({.shape = flat_fan(40)}, 613, 8);
}

void add_bounds(Catalogue& c) {
  DeformableStream still(only({.shape = sheet(3, 3)}));
  for (std::int64_t i = 0; i < 3; ++i) still.add(MainStep{.at = {.tick = i, .key = i == 0}});
  c.section(section::kVertices);
  c.valid("all-still", "Packets without a residual.", still.finished());

  Random random(614);
  DeformableStream exact(only({.shape = sheet(4, 4)}));
  for (std::int64_t i = 0; i < 6; ++i)
    exact.add(
        MainStep{.at = {.tick = i, .key = i == 0}, .visual = 0, .density = 3, .residuals = random_residuals(random, 9, 250)});
  c.section(section::kVertexBounds);
  c.valid("visual-0", "A visual bound of 0: steps of one grid unit.", exact.finished());

  DeformableStream forceless(only({.shape = sheet(4, 4)}));
  for (std::int64_t i = 0; i < 6; ++i)
    forceless.add(MainStep{.at = {.tick = i, .key = i == 0},
                           .triangle = static_cast<std::uint32_t>(i),
                           .haptic = 0,
                           .visual = 50,
                           .residuals = random_residuals(random, 7, 90)});
  c.valid("haptic-0", "A haptic bound of 0 in the area of interest.", forceless.finished());

  DeformableStream levels(only({.shape = sheet(4, 4), .rings = 1}));
  for (std::uint32_t level = 0; level <= 168; level += 4)
    levels.add(MainStep{.at = {.tick = level, .key = level == 0},
                        .triangle = level % 32,
                        .haptic = level,
                        .visual = 1u << std::min(28u, level / 6 + level % 3),
                        .density = level % 4,
                        .residuals = random_residuals(random, 3, 128)});
  c.valid("haptic-indices", "Haptic indices from 0 to 168 beside visual bounds of one to four times as much: every bound ratio.",
          levels.finished());

  DeformableStream wide(only({.shape = sheet(3, 3)}));
  const auto ends = [&](const VertexPrediction& at) {
    return Vec3i{at.vertex % 2 == 0 ? kWidest : -kWidest, 0, at.vertex % 3 == 0 ? -1 : 1};
  };
  for (std::int64_t i = 0; i < 4; ++i)
    wide.add(MainStep{.at = {.tick = i, .key = i == 0}, .visual = i % 2 == 0 ? 1u << 28 : 0, .residuals = ends});
  c.section(section::kVertices);
  c.valid("saturated", "Displacements at +-2^27, by residuals of 31 bits and the largest step.", wide.finished());

  DeformableStream zeros(only({.shape = sheet(3, 3)}));
  DeformableComposer& composer = zeros.composer();
  const MainState rest = initial_main_state(composer.item());
  zeros.add_packet(5, coded_main_packet(0, [&](RangeEncoder& coder, MainModels& models) {
                     Rings rings(composer.item());
                     MainHead head{{.key = true, .tick_delta = 5}};
                     head.visual = 9;
                     code_main_start(coder, models, composer.item(), 1, head);
                     code_main_head(coder, models, composer.item(), rings, rest, head);
                     const VertexHierarchy order = vertex_hierarchy(composer.item());
                     for (const std::uint32_t v : order.order) {
                       const std::size_t level = std::min<std::size_t>(order.depth[v], 2);
                       coder.bit(models.significant[0][0][0][level], 1);
                       for (int axis = 0; axis < 3; ++axis) coder.signed_value(models.component[0][level][0], 0);
                     }
                   }));
  c.valid("significant-zeros", "Every vertex is said to have a residual, and all are 0: none counts as coded.", zeros.finished());
}

void add_touches(Catalogue& c) {
  for (const std::uint8_t rings : {std::uint8_t{0}, std::uint8_t{32}}) {
    c.section(section::kRings);
    c.valid("rings-" + std::to_string(rings), "An area of interest of " + std::to_string(rings) + " rings.",
            random_walk({.shape = box(5, 4, 2), .rings = rings}, 620u + rings, 10));
  }
  DeformableStream moves(only({.shape = sheet(8, 8)}));
  std::int64_t tick = 0;
  const auto touch = [&](std::optional<std::uint32_t> triangle) {
    moves.add(MainStep{.at = {.tick = tick, .key = tick == 0}, .triangle = triangle, .haptic = 20, .visual = 300});
    ++tick;
  };
  touch({});
  for (const std::uint32_t triangle : {60u, 60u, 61u, 45u, 29u, 127u, 0u}) touch(triangle);
  touch({});
  touch({});
  for (const std::uint32_t triangle : {0u, 1u, 2u}) touch(triangle);
  c.section(section::kTriangle);
  c.valid("touches", "No touch, the same triangle, one near, one far, none, and again.", moves.finished());
  DeformableStream many(only({.shape = flat_fan(100)}));
  for (const std::uint32_t triangle : {5u, 0u, 62u, 63u, 99u, 36u})
    many.add(MainStep{.at = {.tick = triangle == 5 ? 0 : 9, .key = triangle == 5}, .triangle = triangle});
  c.valid("near-places", "Triangles at the first and last place of a list of 63 of 99, and beyond it.", many.finished());
}

void add_basis(Catalogue& c) {
  c.section(section::kTime);
  c.valid("one-mode", "A basis of one mode.", random_walk(with_modes({.shape = sheet(4, 3)}, 1, 640), 640, 40));
  c.valid("48-modes", "A basis of 48 modes: every group of coefficients.",
          random_walk(with_modes({.shape = sheet(3, 3)}, 48, 641), 641, 24));
  c.valid("64-modes", "The largest basis.", random_walk(with_modes({.shape = one_triangle()}, 64, 642), 642, 12));
  c.valid("skipped-frames", "A basis and packets 0 to 42 frames apart: motion ends after 8.",
          random_walk(with_modes({.shape = sheet(3, 2), .frame_period = 512}, 4, 643), 643, 60, 3, 28));
  c.valid("short-frames", "The shortest frame: 256 in a tick.",
          random_walk(with_modes({.shape = one_triangle(), .frame_period = 1}, 3, 644), 644, 12, 2, 3));
  c.valid("long-frames", "The longest frame: 2^20 ticks.",
          random_walk(with_modes({.shape = one_triangle(), .frame_period = 1 << 28}, 3, 645), 645, 12, 2, 700001));

  RawDeformable extreme{.shape = one_triangle(), .mode_steps = {65535, 1, 4096}};
  for (int i = 0; i < 27; ++i) extreme.entries.push_back(i % 2 == 0 ? 2047 : -2047);
  DeformableStream large(only(extreme));
  Random random(646);
  for (std::int64_t i = 0; i < 40; ++i) {
    const std::int32_t sign = i / 6 % 2 == 0 ? 1 : -1;
    MainStep step{.at = {.tick = i + i / 7, .key = i == 0}, .visual = 1u << 28};
    step.coefficients = {i % 3 == 0 ? sign * kWidest : sign, -sign * kWidest, random.integer(30)};
    large.add(step);
  }
  c.valid("saturated-coefficients", "Coefficients of 31 bits, the largest and the smallest step, entries of +-2047.",
          large.finished());

  const RawDeformable item = with_modes({.shape = sheet(5, 4)}, 6, 647);
  DeformableStream swing(only(item));
  for (std::int64_t i = 0; i < 80; ++i) {
    MainStep step{.at = {.tick = i, .key = i == 0}, .visual = 4096};
    for (std::int64_t k = 0; k < 6; ++k)
      step.coefficients.push_back(i < 4 ? static_cast<std::int32_t>(20 * (k + 1) * (i - 1)) : i % 9 == k ? 1 : 0);
    swing.add(step);
  }
  c.valid("motion", "Eighty packets from which predictor coefficients follow: a basis moves by itself.", swing.finished());

  DeformableStream shown(only(with_modes({.shape = sheet(3, 3), .frame_period = 768}, 4, 648)));
  for (const std::int64_t tick : {0ll, 3ll, 6ll, 9ll, 12ll, 60ll, 63ll, 66ll, 120ll})
    shown.add(MainStep{.at = {.tick = tick, .key = tick == 0},
                       .visual = 2000,
                       .coefficients = {random.integer(6), random.integer(6), 3, -2},
                       .residuals = random_residuals(random, 3, 20)});
  c.valid("shown", "What a client shows at every tick: motion goes on for 8 frames.", shown.finished(), {}, "linear");
}

}  // namespace

void add_deformable_main(Catalogue& c) {
  add_shapes(c);
  c.section(section::kCodingOrder);
  c.valid("depth-23", "A fan whose coding order has all 24 depths; the last keeps not all.", level_23());
  c.section(section::kVertices);
  c.valid("membrane", "The membrane of the thesis, 714 vertices, under a press that moves.", membrane());
  add_bounds(c);
  add_touches(c);
  add_basis(c);
}

}  // namespace tactus::conformance
