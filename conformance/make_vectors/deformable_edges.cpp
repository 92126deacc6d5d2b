// SPDX-License-Identifier: Apache-2.0
/// Edges of the arithmetic of profile main.
#include <array>
#include <span>
#include <utility>
#include <vector>

#include <tactus/deformable/motion.h>
#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr std::int32_t kFarthest = 1 << 27;

/// Three packets of any residuals.
Bytes shaken(const Shape& shape, std::uint64_t seed) {
  DeformableStream stream(only({.shape = shape}));
  Random random(seed);
  for (std::int64_t i = 0; i < 3; ++i)
    stream.add(MainStep{.at = {.tick = i, .key = i == 0}, .density = 3, .residuals = random_residuals(random, 9, 200)});
  return stream.finished();
}

/// A vertex, the last one, that neighbours all others.
Shape star(const std::vector<Vec3i>& rest) {
  Shape out{rest, {}};
  const auto centre = static_cast<std::uint32_t>(rest.size()) - 1;
  for (std::uint32_t i = 0; i < centre; ++i) out.triangles.push_back({i, (i + 1) % centre, centre});
  return out;
}

/// The centre's parents: a weight of more than 2, and a pivot that is above 0, but too small.
Shape steep_and_flat() {
  const Shape steep = star({{0, 2, 0}, {1, 0, 0}, {1, 2, 0}, {2, 1, 1}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 0, 2}, {1, 2, 0}});
  const Shape flat = star({{0, 0, 0}, {2, 0, 1}, {0, 1, 0}, {0, 2, 0}, {1, 1, 1}, {1, 1, 1}, {0, 1, 0}, {0, 1, 0}, {2, 1, 1}});
  return both(steep, moved(flat, {100, 0, 0}));
}

/// A haptic level that would fall below 0 stays there.
Bytes haptic_below_0() {
  DeformableStream stream(only({.shape = one_triangle()}));
  stream.add(MainStep{.at = {.tick = 10, .key = true}, .triangle = 0u, .haptic = 5});
  stream.add_packet(11, coded_main_packet(1, [](RangeEncoder& coder, MainModels& models) {
                      coder.bit(models.key, 0);
                      coder.signed_value(models.late, 0);
                      coder.bit(models.touched[1], 1);
                      coder.bit(models.same_triangle, 1);
                      coder.signed_value(models.haptic, -std::numeric_limits<std::int32_t>::max());
                      coder.bit(models.same_visual, 1);
                      coder.tree<2>(models.density[1], 3);
                    }));
  return stream.bytes();
}

/// Points of a lattice of 27 places, copies among them, and triangles between any three: where a unit is a step of the lattice, the
/// matrix of some vertices' parents is not definite.
Shape crowded(std::uint64_t seed, std::int32_t step) {
  Random random(seed);
  Shape shape;
  for (int i = 0; i < 60; ++i) {
    Vec3i place{};
    for (auto& x : place) x = (static_cast<std::int32_t>(random.below(3)) - 1) * step;
    shape.rest.push_back(place);
  }
  while (shape.triangles.size() < 150) {
    const Triangle t{random.below(60), random.below(60), random.below(60)};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) shape.triangles.push_back(t);
  }
  return shape;
}

Bytes crowded_stream(std::int32_t step) {
  DeformableStream stream(only({.shape = crowded(77, step)}));
  Random random(78);
  for (int i = 0; i < 3; ++i)
    stream.add(MainStep{.at = {.tick = i, .key = i == 0}, .density = 3, .residuals = random_residuals(random, 9, 200)});
  return stream.finished();
}

/// One star after the other, each the corners and then the centre.
Shape row_of(std::span<const std::vector<Vec3i>> stars) {
  Shape out;
  for (const auto& rest : stars) out = both(out, moved(star(rest), {static_cast<std::int32_t>(20 * out.rest.size()), 0, 0}));
  return out;
}

/// Centres whose parents' matrix is barely definite: sums and solutions beyond the limits that they are clamped to, a sum of solutions
/// below 0, quotients that lie halfway. Found by search.
Shape clamped() {
  return row_of(std::array<std::vector<Vec3i>, 6>{
      {{{0, 2, -1}, {0, 2, 0}, {1, 1, 2}, {2, 4, 2}, {0, 2, 0}, {0, 2, 1}, {0, 2, 0}, {-1, 2, 0}, {0, 2, 0}},
       {{0, 1, 0}, {0, 0, 3}, {3, -1, 0}, {3, 2, 2}, {1, 3, 3}, {1, 3, 2}, {1, 3, 2}, {0, 3, 2}, {1, 4, 1}, {1, 3, 2}, {1, 3, 2}},
       {{3, 2, -1}, {3, -1, 0}, {3, 0, 0}, {3, 0, 0}, {3, 0, 0}, {3, -1, 0}, {3, 0, 0}, {2, 0, 3}, {2, 0, 0}},
       {{1, 2, 5}, {1, 3, 4}, {1, 3, 5}, {1, 3, 5}, {2, 5, 5}, {1, 3, 5}, {-1, 4, 4}, {1, 2, 5}, {5, 2, 2}, {1, 3, 5}},
       {{0, 4, 1}, {1, 2, 3}, {1, 2, 4}, {1, 4, 2}, {4, 3, 0}, {1, 2, 1}, {4, 2, 3}, {1, 4, 2}, {1, 2, 2}},
       {{1, 3, 0}, {0, 2, 0}, {3, 3, 0}, {0, 3, 0}, {1, 2, 0}, {0, 0, 0}, {1, 3, 0}, {3, 2, 0}, {0, 3, 0}}}});
}

/// The same of an object so wide that distances are of steps of four: rounding makes them differ more from those of points. One pivot
/// is 2^18. Found by search.
Shape clamped_wide() {
  const Shape stars = row_of(std::array<std::vector<Vec3i>, 6>{
      {{{13, 5, 11}, {11, 6, 2}, {7, 7, 9}, {4, 0, 12}, {5, 2, 7}, {4, 2, 10}, {0, 14, 13}, {5, 1, 7}, {0, 5, 0}},
       {{13, 4, 11}, {12, 2, 4}, {15, 6, 3}, {2, 1, 5}, {10, 1, 3}, {4, 14, 2}, {4, 14, 2}, {11, 6, 5}},
       {{0, 22, 10},
        {13, 23, 16},
        {18, 11, 5},
        {25, 14, 9},
        {8, 25, 23},
        {6, 9, 4},
        {12, 24, 16},
        {10, 25, 16},
        {11, 24, 16},
        {8, 25, 23},
        {11, 25, 16}},
       {{3, 7, 11}, {1, 5, 2}, {11, 4, 2}, {11, 5, 2}, {10, -3, 1}, {1, 3, 3}, {2, 5, 5}, {1, 3, 5}, {5, 2, 11}, {3, 7, 8}},
       {{3, 2, 14}, {11, 4, 0}, {6, 15, 9}, {3, 3, 11}, {12, 5, 0}, {2, 2, 12}, {1, 1, 11}, {10, 4, -1}, {8, 8, 13}, {4, 7, 6}},
       {{16, 9, 14}, {8, 11, 5}, {17, 14, 3}, {18, 9, 13}, {16, 8, 14}, {13, 1, 17}, {18, 11, 14}, {18, 8, 13}}}});
  return both(stars, moved(one_triangle(), {600000, 0, 0}));
}

/// Every touched vertex goes from the lower end of displacements up by one step of the bound of a level.
Bytes coarsest_levels() {
  DeformableStream stream(only({.shape = one_triangle()}));
  for (std::uint32_t level = 163; level <= 168; ++level) {
    const auto down = [](const VertexPrediction& at) {
      return at.predicted[0] > 0 ? Vec3i{} : Vec3i{at.predicted[0] < 0 ? 0 : -1, 0, 0};
    };
    const auto up = [](const VertexPrediction& at) { return at.predicted[0] == -kFarthest ? Vec3i{1, 0, 0} : Vec3i{}; };
    stream.add(MainStep{.at = {.tick = level, .key = true}, .visual = 1u << 28, .residuals = down});
    stream.add(MainStep{.at = {.tick = level}, .triangle = 0u, .haptic = level, .visual = 1u << 28, .residuals = up});
  }
  return stream.finished();
}

/// Bounds h of 2 beside 3, 1 beside 3 and 4, and 4 beside 4.
Bytes equal_tightness() {
  struct Bound {
    std::uint32_t haptic, visual;
  };
  DeformableStream stream(only({.shape = sheet(2, 2)}));
  Random random(710);
  std::int64_t tick = 0;
  for (const auto& [haptic, visual] : {Bound{7, 3}, Bound{1, 3}, Bound{1, 4}, Bound{13, 4}}) {
    stream.add(MainStep{.at = {.tick = tick, .key = tick == 0},
                        .triangle = 0u,
                        .haptic = haptic,
                        .visual = visual,
                        .residuals = random_residuals(random, 3, 128)});
    ++tick;
  }
  return stream.finished();
}

/// Triangle 60 of a sheet, in whose rings 1 and 2 there are `near` triangles, then the triangle of that place.
Bytes beyond_ring_2() {
  DeformableStream stream(only({.shape = sheet(8, 8)}));
  stream.add(MainStep{.at = {.tick = 0, .key = true}, .triangle = 60u});
  Rings rings(stream.composer().item());
  const auto near = static_cast<std::uint32_t>(rings.triangles_around(60, 2).size()) - 1;
  return stream
      .add_packet(1, coded_main_packet(1,
                                       [&](RangeEncoder& coder, MainModels& models) {
                                         coder.bit(models.key, 0);
                                         coder.signed_value(models.late, 0);
                                         coder.bit(models.touched[1], 1);
                                         coder.bit(models.same_triangle, 0);
                                         coder.bit(models.near_triangle, 1);
                                         coder.tree<6>(models.near_place, near);
                                         coder.signed_value(models.haptic, 0);
                                         coder.bit(models.same_visual, 1);
                                         coder.tree<2>(models.density[1], 1);
                                       }))
      .bytes();
}

/// A basis whose steps are 1 where the visual bound is 0, and whose displacements stay small.
RawDeformable quiet_basis(std::size_t modes) {
  RawDeformable item{.shape = one_triangle(), .mode_steps = std::vector<std::uint16_t>(modes, 1)};
  for (std::size_t i = 0; i < 9 * modes; ++i) item.entries.push_back(static_cast<std::int32_t>(i % 5) * 300 - 600);
  return item;
}

/// Sums 11, 12 and 22 of 1, 8 and 31, and of 1, 10 and 31: d = 2 * 32 - 8^2 = 0 and 2 * 32 - 10^2 < 0.
Bytes no_taps() {
  DeformableStream stream(only(quiet_basis(2)));
  std::int64_t tick = 0;
  const auto add = [&](std::int64_t frames, std::int32_t first, std::int32_t second) {
    tick += frames;
    stream.add(MainStep{.at = {.tick = tick, .key = tick == 0}, .visual = 0, .coefficients = {first, second}});
  };
  add(0, 0, 0);
  add(2, 16, 20);  // last and before are 8, and 10
  add(0, -7, -9);  // last is 1
  add(1, 0, 3);    // the sums are 1, 8 and 64, and 1, 10 and 100; the second mode's 01 and 02 are 3 and 30
  add(2, 0, -1);   // last and before are 0
  for (int i = 0; i < 64; ++i) add(1, 0, 0);
  add(0, 5, 5);
  add(1, 0, 0);
  add(3, 1, -1);
  return stream.finished();
}

/// A stream of one mode whose coefficient moves as told, whatever is predicted.
class Driven {
 public:
  Driven() : stream_(only(quiet_basis(1))), motion_(1) { move(0, 0); }

  /// A packet so many frames after the one before; by so much the coefficient has moved since.
  Driven& move(std::uint32_t frames, std::int32_t by) {
    std::int32_t predicted = 0;
    motion_.predict(frames, {&predicted, 1});
    motion_.update(frames, {&by, 1});
    tick_ += frames;
    stream_.add(
        MainStep{.at = {.tick = tick_, .key = std::exchange(first_, false)}, .visual = 0, .coefficients = {by - predicted}});
    return *this;
  }
  /// The last increment and the one before it.
  Driven& increments(std::int32_t last, std::int32_t before) { return move(2, 2 * before).move(0, last - before); }
  Driven& rest(int packets) {
    for (int i = 0; i < packets; ++i) move(1, 0);
    return *this;
  }
  Bytes finished() { return stream_.finished(); }

 private:
  DeformableStream stream_;
  ModeMotion motion_;
  std::int64_t tick_ = 0;
  bool first_ = true;
};

/// Increments of 3, 5 and 7, then two of 2^26.
Bytes large_increments() { return Driven().move(1, 3).move(1, 5).move(1, 7).increments(1 << 26, 1 << 26).move(1, 0).finished(); }

/// Correlations 11, 12 and 22 of 1, 10 and 31, whose determinant is below 0, and two increments of 20000.
Bytes no_predictor_for_large() {
  return Driven().increments(1, 10).move(1, 3).increments(0, 0).rest(64).increments(20000, 20000).move(1, 0).finished();
}

/// Correlations 11, 12 and 22 of 1, 9 and 40: d = 2 * 41 - 9^2 = 1.
Bytes determinant_1() { return Driven().increments(1, 9).move(1, 3).increments(0, 0).rest(32).move(0, 5).move(1, 0).finished(); }

/// Increments that double, then an increment of 1 or -1 after or before one of 0.
Bytes single_units() {
  Driven out;
  for (std::int32_t by = 1; by <= 4096; by *= 2) out.move(1, by);
  for (const std::int32_t unit : {1, -1}) out.increments(unit, 0).move(1, 0).increments(0, unit).move(1, 0);
  return out.finished();
}

/// Packets in a scene of 65538 triangles, all of the same corners.
Input crowd_of_triangles(std::span<const MainStep> steps) {
  const Shape shape{one_triangle().rest, std::vector<Triangle>(65538, {0, 1, 2})};
  DeformableStream stream(only({.shape = shape, .rings = 0}));
  const std::size_t end = stream.bytes().size() - 5;  // of the triangles, before basis and crc
  for (const MainStep& step : steps) stream.add(step);
  const std::size_t triangles = 65537;
  return {stream.finished(), {end - 3 * triangles, {0, 2, 2}, triangles}};
}

/// The last two triangles.
Input number_of_17_bits() {
  return crowd_of_triangles(std::array{MainStep{.at = {.tick = 0, .key = true}, .triangle = 65537u, .haptic = 3},
                                       MainStep{.at = {.tick = 1}, .triangle = 65536u, .haptic = 3}});
}

/// The last triangles, in key packets at several ticks.
Input numbers_of_17_bits() {
  std::vector<MainStep> steps;
  for (const std::int64_t tick : {0, 1, 2, 9, 40, 700})
    steps.push_back({.at = {.tick = tick, .key = tick != 2},
                     .triangle = static_cast<std::uint32_t>(65537 - tick % 7),
                     .haptic = static_cast<std::uint32_t>(tick % 5)});
  return crowd_of_triangles(steps);
}

/// A touch of either triangle of two.
Bytes two_triangles() {
  DeformableStream stream(only({.shape = sheet(1, 1)}));
  for (std::uint32_t i = 0; i < 4; ++i)
    stream.add(MainStep{.at = {.tick = i, .key = true}, .triangle = i % 2, .haptic = 20, .visual = 90});
  return stream.finished();
}

/// No bound allows an error, neither the haptic nor the visual one.
Bytes both_bounds_0() {
  DeformableStream stream(only({.shape = sheet(3, 3), .rings = 1}));
  Random random(712);
  for (std::uint32_t i = 0; i < 4; ++i)
    stream.add(MainStep{.at = {.tick = i, .key = i == 0},
                        .triangle = 5u,
                        .haptic = 0,
                        .visual = 0,
                        .residuals = random_residuals(random, 4, 128)});
  return stream.finished();
}

/// A coefficient of 1 is as large as there may be.
RawDeformable loud_basis(std::uint8_t layered) {
  RawDeformable item = quiet_basis(2);
  item.mode_steps = {65535, 65535};
  item.layered = layered;
  return item;
}

/// Twenty packets of one frame add up to more than 32 bits; then motion is predicted from that, up to 9 frames ahead. At last a steady
/// motion: eight frames of it are more than a displacement can be, and a coefficient takes as much back.
Bytes saturated_prediction() {
  DeformableStream stream(only(loud_basis(0)));
  Random random(711);
  std::int64_t tick = 0;
  bool first_packet = true;
  const auto add = [&](std::int64_t frames, std::int32_t first, std::int32_t second) {
    tick += frames;
    stream.add(MainStep{
        .at = {.tick = tick, .key = std::exchange(first_packet, false)}, .visual = 1u << 28, .coefficients = {first, second}});
  };
  add(0, 0, 0);
  for (int i = 0; i < 20; ++i) add(0, 1, -1);
  for (int i = 0; i < 40; ++i) {
    const std::int64_t frames = random.below(3) == 0 ? random.below(10) : 1;
    const auto first = static_cast<std::int32_t>(random.below(3)) - 1;
    add(frames, first, static_cast<std::int32_t>(random.below(3)) - 1);
  }
  for (int i = 0; i < 20; ++i) add(1, 1, -1);
  add(8, -1, 1);
  return stream.finished();
}

/// Motion swings so that its increments' sums after one frame and after three are at the two ends. A haptic layer takes the first frame.
Bytes saturated_split() {
  DeformableStream stream(only(loud_basis(1)));
  std::int64_t tick = 0;
  const auto visual = [&](std::int64_t frames, std::int32_t by) {
    tick += frames;
    stream.add(
        MainStep{.at = {.tick = tick, .key = tick == 0}, .layer = Layer::visual, .visual = 1u << 28, .coefficients = {by, -by}});
  };
  visual(0, 0);
  for (int i = 0; i < 13; ++i) visual(1, i % 4 < 2 ? 1 : -1);
  ++tick;
  stream.add(MainStep{.at = {.tick = tick}, .layer = Layer::haptic, .triangle = 0u, .haptic = 9, .visual = 1u << 28});
  visual(2, 0);
  return stream.finished();
}

}  // namespace

void add_deformable_edges(Catalogue& c) {
  c.section(section::kHead);
  c.valid("haptic-below-0", "haptic_change takes it far below 0: haptic is 0.", haptic_below_0(), {"R-DEF-10"});
  c.section(section::kWeights);
  c.valid("crowded", "Copies and near neighbours among parents, on a surface of two units: some matrices are not definite.",
          crowded_stream(1));
  c.valid("crowded-wide", "The same surface a thousand times as wide.", crowded_stream(1000));
  c.section(section::kCodingOrder);
  c.valid("join-distances", "Shifted distances differ in both directions: which kept neighbour a vertex joins depends on it.",
          shaken(sheet(7, 6, 200001), 700));
  c.section(section::kWeights);
  c.valid("steep-and-flat", "A parent's weight is limited to 2; a pivot is above 0, but below 2^18.",
          shaken(steep_and_flat(), 701));
  c.valid("clamped-weights", "Weights whose sums and solutions are beyond the limits that they are clamped to.",
          shaken(clamped(), 713));
  c.valid("clamped-weights-wide", "The same where distances are shifted; a pivot of 2^18.", shaken(clamped_wide(), 714));
  c.section(section::kVertexBounds);
  c.valid("coarsest-indices", "Steps of the haptic indices 163 to 168.", coarsest_levels(), {"R-DEF-10"});
  c.valid("equal-bound-ratios",
          "Bounds where 3 h is twice the visual bound, 4 h is that and one more, and h is the visual bound.", equal_tightness());
  c.invalid("beyond-ring-2", "The first place beyond rings 1 and 2.", {"invalid", "R-DEF-9"}, beyond_ring_2());
  c.valid("both-bounds-0", "Visual and haptic bounds of 0: neither is less than the other.", both_bounds_0());
  c.section(section::kTriangle);
  c.valid("two-triangles", "The number of a triangle of two takes a bit.", two_triangles());
  c.valid("number-of-17-bits", "The number of a triangle of 65538 takes 17 bits, in two groups.", number_of_17_bits());
  c.valid("numbers-of-17-bits", "The same in key packets, whose heads before and after the number differ.", numbers_of_17_bits());
  c.section(section::kTime);
  c.valid("no-predictor", "Steps of modes of 1, where the visual bound is 0; correlations whose determinant is 0 and below.",
          no_taps());
  c.valid("saturated-prediction", "Coefficients that add up beyond 32 bits in one frame, and what is predicted from them.",
          saturated_prediction());
  c.valid("saturated-layers",
          "A visual layer after a haptic layer: what motion adds between them goes from one end to the other.",
          saturated_split());
  c.valid("large-increments", "Increments of 27 bits beside correlations of few bits.", large_increments());
  c.valid("no-predictor-for-large", "Large increments, and correlations whose determinant is below 0.", no_predictor_for_large());
  c.valid("determinant-1", "Correlations whose determinant is 1.", determinant_1());
  c.valid("single-units", "An increment of 1 or -1, before or after one of 0.", single_units());
}

}  // namespace tactus::conformance
