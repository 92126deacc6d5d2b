// SPDX-License-Identifier: Apache-2.0
/// Elastic bodies at the edges: places where two cases of a rule meet, the ends of ranges, and what tells two orders apart.
#include <algorithm>
#include <array>
#include <utility>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/elastic_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

const std::vector<Told> fades{{0}};
constexpr Vec3i kAbove{4 * kMm, 4 * kMm, kSize + kMm}, kBelow{4 * kMm, 5 * kMm, kSize - 2 * kMm}, kCorner{0, 0, kSize};

std::uint32_t find(const Shape& shape, const Vec3i& at) {
  return static_cast<std::uint32_t>(std::ranges::find(shape.rest, at) - shape.rest.begin());
}
/// Adds a vertex, which is fixed and in no tetrahedron.
std::uint32_t add_vertex(ElasticItem& item, const Vec3i& at) {
  const auto number = static_cast<std::uint32_t>(item.object.shape.rest.size());
  item.object.shape.rest.push_back(at);
  std::uint64_t end = 0;
  for (const auto& [gap, more] : item.body->runs) end += gap + more + 1;
  item.body->runs.push_back({number - end, 0});
  if (number == end) {  // the run before goes on
    item.body->runs.pop_back();
    ++item.body->runs.back()[1];
  }
  return number;
}

// ---- Touch ----

/// A strip of narrow triangles leads to the pad. In one tick the device goes over some 60 of them, each time over one more.
Bytes strip() {
  ElasticItem item = pad(1, 1, 1);
  Shape& shape = item.object.shape;
  constexpr std::int32_t kWidth = kMm / 2;
  std::array<std::uint32_t, 2> edge{find(shape, {kSize, 0, kSize}), find(shape, {kSize, kSize, kSize})};
  for (std::int32_t i = 1; i <= 40; ++i) {
    const std::array next{add_vertex(item, {kSize + i * kWidth, 0, kSize}), add_vertex(item, {kSize + i * kWidth, kSize, kSize})};
    shape.triangles.push_back({edge[0], next[0], edge[1]});
    shape.triangles.push_back({edge[1], next[0], next[1]});
    edge = next;
  }
  std::vector<Move> moves;
  for (std::int64_t i = 0; i < 9; ++i) {
    moves.push_back(
        {10 * i, {static_cast<std::int32_t>(kSize + 29 * kWidth + (2 * i + 1) * kWidth / 4), kSize / 2, kSize + kMm}});
    moves.push_back({10 * i + 7, kBelow});
  }
  return played(scene(item, 5), moves, fades, 110);
}

/// The device is on a corner of the body, neither inside nor outside, before it goes in.
Bytes on_a_corner() {
  return played(scene(changed([](RawDeformable&, RawBody& b) { b.constants[kFriction] = 5; }, pad(1, 1, 1)), 5),
                {{0, kCorner}, {3, kBelow}}, fades, 40);
}

/// The device is inside when it is first told of.
Bytes begins_inside() {
  return played(scene(changed([](RawDeformable&, RawBody& b) { b.constants[kFriction] = 1; }, pad(1, 1, 1)), 5),
                {{7, kBelow, {50 * kSpeed, 0, 0}}, {40, kAbove}}, fades, 70);
}

/// Twice the area of a triangle, as a vector.
std::array<std::int64_t, 3> area(const Shape& shape, const Triangle& t) {
  std::array<std::array<std::int64_t, 3>, 2> e{};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) e[i][axis] = std::int64_t{shape.rest[t[i + 1]][axis]} - shape.rest[t[0]][axis];
  return {e[0][1] * e[1][2] - e[0][2] * e[1][1], e[0][2] * e[1][0] - e[0][0] * e[1][2], e[0][0] * e[1][1] - e[0][1] * e[1][0]};
}

/// Triangles between any vertices of a block, most of which are fixed, and their twins at the same places. Half of the triangles
/// have no area. The device is at places half a cell apart: above vertices and edges, on them, as far from one triangle as from
/// another.
Bytes lattice(std::uint64_t seed, double friction) {
  Random random(seed);
  const Block mesh = block(2, 2, 1, kSize);
  ElasticItem item{{.shape = mesh.shape}, loose(mesh)};
  const auto count = static_cast<std::uint32_t>(mesh.shape.rest.size());
  std::vector<std::uint32_t> fixed;
  for (std::uint32_t v = 0; v < count; ++v)
    if (random.below(3) > 0 || v == 0) fixed.push_back(v);
  item.body->runs = runs_of(fixed);
  for (const Vec3i& at : mesh.shape.rest) add_vertex(item, at);
  Shape& shape = item.object.shape;
  shape.triangles.clear();
  while (shape.triangles.size() < 32) {
    Triangle t{};
    for (std::uint32_t& corner : t) corner = random.below(2 * count);
    if (shape.triangles.size() % 4 == 1) {
      const std::uint32_t i = random.below(3);
      t[i] = (t[(i + 1) % 3] + count) % (2 * count);
    }
    const bool has_area = area(shape, t) != std::array<std::int64_t, 3>{};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0] && has_area == (shape.triangles.size() % 2 == 0))
      shape.triangles.push_back(t);
  }
  item.body->constants[kFriction] = friction;
  std::vector<Move> moves;
  for (std::int64_t tick = 0; tick < 240; tick += 1 + random.below(3)) {
    Vec3i at{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      at[axis] = (static_cast<std::int32_t>(random.below(axis < 2 ? 7 : 5)) - 1) * (kSize / 2);
    moves.push_back({tick, at});
  }
  return played(scene(item, 6), moves, fades, 246);
}

/// With three triangles of next to no area, meters long, which pass by the device: rounding tells which case of the foot applies,
/// and puts it far away, so that the device touches the block.
Bytes needles() {
  const Block mesh = block(1, 1, 1, 1 << 23);
  ElasticItem item{{.shape = mesh.shape}, standing(mesh)};
  constexpr Vec3i kPlace{1 << 22, 1 << 22, 7 << 20};
  constexpr std::array<std::array<Vec3i, 3>, 3> kFromThere{
      {{{{-1314579799, 511796467, -1072381226}, {27, -28, 7}, {-1502376917, 584910252, -1225578545}}},
       {{{-10, 7, 10}, {135549102, -60822269, -177877706}, {677745550, -304111373, -889388570}}},
       {{{11, -28, -14}, {1098372272, 1875372044, -1746057453}, {941461949, 1607461748, -1496620676}}}}};
  for (const auto& corners : kFromThere) {
    Triangle t{};
    for (std::size_t i = 0; i < 3; ++i)
      t[i] = add_vertex(item, {kPlace[0] + corners[i][0], kPlace[1] + corners[i][1], kPlace[2] + corners[i][2]});
    item.object.shape.triangles.push_back(t);
  }
  RawHeader header = scene(item, 5);
  header.grid.position = 30;
  header.grid.velocity = 25;
  return played(header, {{7, kPlace}}, fades, 40);
}

void add_touches(Catalogue& c) {
  c.section(section::kTouch);
  add_device(c, "elastic-64-triangles", "In one tick the device goes over more and more triangles, up to 64 of which it passes.",
             strip());
  add_device(c, "elastic-on-a-corner", "A device that is exactly on a corner of the body does not touch it.", on_a_corner());
  add_device(c, "elastic-begins-inside", "The device is inside when it is first told of; friction holds it from then on.",
             begins_inside());
  add_device(c, "elastic-needles", "Triangles of next to no area, meters long: rounding tells which case of the foot applies.",
             needles());
  int number = 0;
  for (const auto& [seed, friction] : {std::pair{941, 0.5}, {945, 0.5}, {947, 0.5}, {955, 0.5}, {950, 0.0}})
    add_device(
        c, "elastic-lattice-" + std::to_string(++number),
        "Any triangles between vertices of a lattice, half of no area; the device is above vertices and edges, and on them.",
        lattice(static_cast<std::uint64_t>(seed), friction));
}

// ---- From shape to shape ----

/// A body that nothing holds, of next to no stiffness, so that each vertex falls as if alone: along z by exactly `gravity` in the
/// first frame of 1 s, and by twice as much more in each that follows. The grid's step is 2^-30 m.
Bytes falling(double gravity) {
  const Block mesh = block(1, 1, 1, 1 << 23);
  ElasticItem item{{.shape = mesh.shape}, loose(mesh)};
  item.body->materials = {{0x1p-90, 0, 1000}};
  item.body->constants = {0, 0, 0, 0, gravity, 100, 0};
  RawHeader header = scene(item, 1, false);
  header.tick_rate = 1;
  header.grid.position = 30;
  header.grid.velocity = 25;
  return played(header, {}, fades, 6);
}

/// Stiffness damping of 10 s; the device holds the body until it is still, and lets it go.
Bytes creeping() {
  const Block mesh = block(1, 1, 1, 1 << 23);
  ElasticItem item{{.shape = mesh.shape}, standing(mesh)};
  item.body->constants[kMassDamping] = 0;
  item.body->constants[kStiffnessDamping] = 10;
  RawHeader header = scene(item, 1);
  header.tick_rate = 1;
  header.grid.position = 30;
  header.grid.velocity = 25;
  constexpr std::int32_t kTop = 1 << 23, kMiddle = 1 << 22;
  return played(header,
                {{0, {kMiddle, kMiddle, kTop + 9}}, {2, {kMiddle, kMiddle - 9, kTop - 12000}}, {140, {kMiddle, 0, kTop + 9}}},
                fades, 280);
}

void add_shapes(Catalogue& c) {
  c.section(section::kStep);
  add_device(c, "elastic-at-the-end-of-the-range", "The first shape is 2^27 grid units away, the next one is beyond.",
             falling(0.125));
  add_device(c, "elastic-beyond-the-range", "The second shape is more than 2^27 grid units away, downwards.", falling(-0.0625));
  add_device(c, "elastic-slowest", "A body that falls at 2^-30 m/s moves.", falling(-0x1p-30));
  add_device(c, "elastic-too-slow", "A body that falls at three quarters of that does not.", falling(-0x0.cp-30));
  add_device(c, "elastic-creeps", "A body that comes back so slowly that it rests before it is there.", creeping());
  add_device(c, "elastic-frames-of-1024-ticks", "The longest frames.",
             played(scene(pad(1, 1, 1), 1024), {{0, kAbove}, {900, kBelow}, {2500, kAbove}},
                    {{0}, {1023, Following::fading, 6}, {1024, Following::kept, 5}}, 4200));
}

// ---- Declarations ----

/// So many inner vertices, all of them fixed, of one byte for each coordinate.
ElasticItem short_inner(int count) {
  ElasticItem item = cube();
  for (std::int32_t i = 1; i <= count; ++i) item.body->inner.push_back({i, 2 * i, -i});
  item.body->runs.push_back({4, static_cast<std::uint64_t>(count) - 1});
  return item;
}

/// The cube with this profile and frame period, and the declaration ends after `has_body`.
Bytes cut_after(std::uint8_t has_body, std::uint8_t profile, std::uint32_t frame_period) {
  ElasticItem item = cube();
  item.object.profile = profile;
  item.object.frame_period = frame_period;
  RawHeader header = only(item);
  header.elastic = {has_body};
  return header.bytes();
}

}  // namespace

void add_scene_elastic_edges(Catalogue& c) {
  c.section(section::kElastic);
  c.valid("elastic-short-inner", "40 inner vertices of three bytes each: no byte to spare before the tetrahedra.",
          only(short_inner(40)).bytes(), {"R-STR-5"});
  c.invalid("has-body-before-thesis", "has_body is 2, of an object of profile thesis.", {"malformed", "R-ELA-1", "R-ELA-1"},
            cut_after(2, 0, 1280));
  c.invalid("elastic-frame-before-cut", "Frames that are not whole ticks; the declaration ends after has_body.",
            {"invalid", "R-ELA-1", "R-STR-5"}, cut_after(1, 1, 257));
}

void add_client_elastic_edges(Catalogue& c) {
  add_touches(c);
  add_shapes(c);
}

}  // namespace tactus::conformance
