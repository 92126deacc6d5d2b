// SPDX-License-Identifier: Apache-2.0
/// Edges of the arithmetic of profile main: spec/60-mesh.md sections 4 to 7.
#include <utility>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/mesh_build.h"

namespace tactus::conformance {
namespace {

constexpr std::int32_t kFarthest = 1 << 27;

/// Three packets of any residuals.
Bytes shaken(const Shape& shape, std::uint64_t seed) {
  MeshStream stream(only({.shape = shape}));
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

/// Every touched vertex goes from the lower end of displacements up by one step of the bound of a level.
Bytes coarsest_levels() {
  MeshStream stream(only({.shape = one_triangle()}));
  for (std::uint32_t level = 163; level <= 168; ++level) {
    const auto down = [](const VertexPlace& at) { return at.place[0] > 0 ? Vec3i{} : Vec3i{at.place[0] < 0 ? 0 : -1, 0, 0}; };
    const auto up = [](const VertexPlace& at) { return at.place[0] == -kFarthest ? Vec3i{1, 0, 0} : Vec3i{}; };
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
  MeshStream stream(only({.shape = sheet(2, 2)}));
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
  MeshStream stream(only({.shape = sheet(8, 8)}));
  stream.add(MainStep{.at = {.tick = 0, .key = true}, .triangle = 60u});
  Rings rings(stream.composer().mesh());
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
RawMesh quiet_basis(std::size_t modes) {
  RawMesh mesh{.shape = one_triangle(), .mode_steps = std::vector<std::uint16_t>(modes, 1)};
  for (std::size_t i = 0; i < 9 * modes; ++i) mesh.entries.push_back(static_cast<std::int32_t>(i % 5) * 300 - 600);
  return mesh;
}

/// Sums 11, 12 and 22 of 1, 8 and 31, and of 1, 10 and 31: d = 2 * 32 - 8^2 = 0 and 2 * 32 - 10^2 < 0.
Bytes no_taps() {
  MeshStream stream(only(quiet_basis(2)));
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

/// A coefficient of 1 is as large as there may be.
RawMesh loud_basis(std::uint8_t split) {
  RawMesh mesh = quiet_basis(2);
  mesh.mode_steps = {65535, 65535};
  mesh.split = split;
  return mesh;
}

/// Twenty packets of one frame add up to more than 32 bits; then motion is predicted from that, up to 9 frames ahead. At last a steady
/// motion: eight frames of it are more than a displacement can be, and a coefficient takes as much back.
Bytes saturated_prediction() {
  MeshStream stream(only(loud_basis(0)));
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

/// Motion swings so that its sums after one frame and after three are at the two ends. A haptic half takes the first frame.
Bytes saturated_split() {
  MeshStream stream(only(loud_basis(1)));
  std::int64_t tick = 0;
  const auto visual = [&](std::int64_t frames, std::int32_t by) {
    tick += frames;
    stream.add(
        MainStep{.at = {.tick = tick, .key = tick == 0}, .half = Layer::visual, .visual = 1u << 28, .coefficients = {by, -by}});
  };
  visual(0, 0);
  for (int i = 0; i < 13; ++i) visual(1, i % 4 < 2 ? 1 : -1);
  ++tick;
  stream.add(MainStep{.at = {.tick = tick}, .half = Layer::haptic, .triangle = 0u, .haptic = 9, .visual = 1u << 28});
  visual(2, 0);
  return stream.finished();
}

}  // namespace

void add_mesh_edges(Catalogue& c) {
  c.valid("join-distances", "Shifted distances differ in both directions: which kept neighbour a vertex joins depends on it.",
          shaken(sheet(7, 6, 200001), 700));
  c.valid("steep-and-flat", "A parent's weight is limited to 2; a pivot is above 0, but below 2^18.",
          shaken(steep_and_flat(), 701));
  c.valid("coarsest-levels", "Steps of the haptic levels 163 to 168.", coarsest_levels(), {"R-MES-10"});
  c.valid("equal-tightness", "Bounds where 3 h is twice the visual bound, 4 h is that and one more, and h is the visual bound.",
          equal_tightness());
  c.invalid("beyond-ring-2", "The first place beyond rings 1 and 2.", {"invalid", "R-MES-9"}, beyond_ring_2());
  c.valid("no-taps", "Steps of modes of 1, where the visual bound is 0; sums whose determinant is 0 and below.", no_taps());
  c.valid("saturated-prediction", "Coefficients that add up beyond 32 bits in one frame, and what is predicted from them.",
          saturated_prediction());
  c.valid("saturated-split", "A visual half after a haptic half: what motion adds between them goes from one end to the other.",
          saturated_split());
}

}  // namespace tactus::conformance
