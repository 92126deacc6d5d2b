// SPDX-License-Identifier: Apache-2.0
/// What a client shows of elastic bodies that its device deforms.
#include <algorithm>
#include <utility>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/elastic_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

/// Down onto the block, 3 mm deep, along x over 6 mm, up and away.
std::vector<Move> over(const Vec3i& top) {
  const auto at = [&](std::int32_t x, std::int32_t y, std::int32_t z) { return Vec3i{top[0] + x, top[1] + y, top[2] + z}; };
  return {{0, at(0, 0, kMm), {0, 0, -100 * kSpeed}},
          {40, at(0, 0, -3 * kMm), {80 * kSpeed, 15 * kSpeed, 0}},
          {115, at(6 * kMm, kMm, -3 * kMm), {-20 * kSpeed, 0, 200 * kSpeed}},
          {150, at(5 * kMm, kMm, 4 * kMm)}};
}

constexpr Vec3i kTop{7 * kMm, 4 * kMm, kSize};
const std::vector<Told> fades{{0}};
const std::vector<Told> mixed{{3, Following::fading, 6}, {48, Following::kept, 5},    {77, Following::none, 4},
                              {93, Following::kept, 6},  {120, Following::fading, 7}, {131, Following::fading, 0}};

template <class Change>
ElasticItem changed(Change change) {
  return changed(change, pad());
}

Bytes pressed(const ElasticItem& item, const std::vector<Told>& told = fades, std::uint32_t ticks = 5) {
  return played(scene(item, ticks), over(kTop), told, 190);
}

ElasticItem with_inner() {
  ElasticItem item = pad(2, 2, 2);
  item.body->materials = {{15000, 0.45, 1000}, {90000, 0.1, 1900}};
  item.body->lengths = {{20, 0}, {7, 1}, {21, 0}};
  item.body->constants[kFriction] = 0.3;
  return item;
}

/// Its triangles are those at the top, but one, and others that cross the inside or are no area at all.
ElasticItem odd_triangles() {
  ElasticItem item = pad();
  std::vector<Triangle> kept;
  const auto& rest = item.object.shape.rest;
  for (const Triangle& t : item.object.shape.triangles)
    if (std::ranges::all_of(t, [&](std::uint32_t v) { return rest[v][2] > 0; })) kept.push_back(t);
  kept.erase(kept.begin() + 1);
  const auto find = [&](int x, int y, int z) {
    const Vec3i at{x * kSize, y * kSize, z * kSize};
    return static_cast<std::uint32_t>(std::ranges::find(rest, at) - rest.begin());
  };
  kept.push_back({find(0, 0, 0), find(2, 0, 1), find(1, 1, 1)});
  kept.push_back({find(0, 0, 1), find(1, 0, 1), find(2, 0, 1)});  // on a line
  kept.push_back({find(1, 1, 1), find(1, 0, 1), find(0, 1, 1)});
  kept.push_back({find(1, 1, 1), find(0, 1, 1), find(1, 0, 1)});  // the same, the other way about
  item.object.shape.triangles = kept;
  return item;
}

/// A strip of narrow triangles, over which the device goes at 4 m/s: several of them in a tick.
Bytes swept(double friction) {
  const Block mesh = block(6, 1, 1, 2 * kMm);
  ElasticItem item{{.shape = mesh.shape}, standing(mesh)};
  item.body->constants[kFriction] = friction;
  const std::int32_t y = kMm, z = 2 * kMm - kMm / 2;
  return played(scene(item, 2),
                {{0, {kMm / 2, y, z + kMm}, {0, 0, -400 * kSpeed}},
                 {4, {kMm / 2, y, z}, {4000 * kSpeed, 0, 0}},
                 {6, {10 * kMm, y, z}, {-3000 * kSpeed, 0, 0}},
                 {9, {kMm, y + kMm / 3, z}, {1500 * kSpeed, 0, 0}},
                 {16, {11 * kMm, y, z}, {-6000 * kSpeed, -200 * kSpeed, 0}},
                 {18, {2 * kMm, y, z}, {0, 0, 300 * kSpeed}}},
                {{1}, {11, Following::kept, 4}}, 50);
}

/// Two device packets of one tick, the first of which comes last.
Bytes overtaken() {
  RawHeader header = scene(pad(), 5);
  header.baseline_span = 8;
  ElasticStream stream(header);
  const Update down{.residual = {{{kTop[0], kTop[1], kTop[2] + kMm}, {0, 0, -100 * kSpeed}}}};
  stream.add(0, {.at = {.tick = 0, .key = true}, .following = Following::fading});
  stream.add_device({.tick = 0, .updates = {down}, .key = true, .sequence = std::uint16_t{0}});
  const Update slow{.residual = {{{}, {9 * kSpeed, 0, 70 * kSpeed}}}}, stop{.residual = {{{}, {30 * kSpeed, 0, 100 * kSpeed}}}};
  stream.add_device({.tick = 33, .updates = {stop}, .baseline = 2, .sequence = std::uint16_t{2}});
  stream.add_device({.tick = 33, .updates = {slow}, .baseline = 1, .sequence = std::uint16_t{1}});
  stream.add(0, {.at = {.tick = 61}, .following = Following::kept});
  stream.add_device({.tick = 70, .updates = {slow}, .baseline = 1, .sequence = std::uint16_t{3}});
  return stream.add(0, {.at = {.tick = 130}, .following = Following::kept}).finished();
}

/// Two bodies and a sheet, and a rigid cube that is driven.
Bytes several() {
  RawHeader header{.objects = {{"device"}, {"rail", Dof::x, {0, 9 * kSize, 0}}}};
  header.flags = 4 | 16;
  ByteWriter d(header.driven);
  for (const std::uint32_t c : {0u, 0u, 0u, 0u, 0u, 0u, 9000u, 100u, 1u, 1u, 1u, 0u}) d.u32(c);
  ElasticItem first = pad(), second = changed(
                                 [](RawDeformable&o, RawBody&b) {
                                   o.name = "other";
                                   o.shape = moved(o.shape, {0, 0, -kSize / 4});
                                   o.frame_period = 256 * 7;
                                   b.constants[kGravityX] = 3;
                                   b.constants[kFriction] = 2;
                                 },
                                 pad(1, 1, 1));
  first.object.frame_period = 256 * 5;
  ElasticStream stream(with_elastic(header, {first, {{.shape = sheet(1, 1), .name = "sheet"}}, second}));
  const auto moves = over({5 * kMm, 4 * kMm, kSize});
  std::int64_t tick = 0;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    stream.device(moves[i].tick, moves[i].place, moves[i].velocity);
    tick = moves[i].tick;
    stream.add(0, {.at = {.tick = tick, .key = i == 0}, .following = Following::fading});
    stream.add(2, {.at = {.tick = tick + 1, .key = i == 0}, .following = i % 2 == 0 ? Following::kept : Following::fading});
    stream.add(1, {.at = {.tick = tick + 2, .key = i == 0}});
  }
  return stream.add(0, {.at = {.tick = 180}, .following = Following::fading}).finished();
}

/// What differs fades to nothing, without a device near; then it is kept, at the end of the range.
Bytes faded() {
  ElasticStream stream(scene(pad(1, 1, 1), 1));
  Random random(911);
  stream.device(0, {0, 0, 9 * kSize});
  MainStep step{.at = {.tick = 2, .key = true}, .following = Following::fading, .residuals = random_residuals(random, 14, 250)};
  stream.add(0, step);
  step.at = {.tick = 110};
  step.following = Following::kept;
  constexpr std::int32_t kEnd = 1 << 27;
  step.residuals = towards([](std::uint32_t v) { return v % 2 == 0 ? Vec3i{kEnd, -kEnd, kEnd} : Vec3i{-kEnd, 5, kEnd - 1}; });
  stream.add(0, step);
  const Vec3i low{5 * kMm, 5 * kMm, 8 * kMm};
  stream.device(120, low).device(140, {5 * kMm, 5 * kMm, 7 * kMm});
  return stream.add(0, {.at = {.tick = 150}, .following = Following::fading}).finished();
}

/// Any body, materials, constants, clock and way of the device, which goes from place to place in and about the body.
Bytes any(std::uint64_t seed) {
  Random random(seed);
  constexpr std::array<std::array<int, 3>, 6> kBlocks{{{1, 1, 1}, {2, 1, 1}, {1, 1, 2}, {2, 2, 1}, {2, 1, 2}, {1, 3, 1}}};
  const auto& [nx, ny, nz] = kBlocks[random.below(6)];
  const unsigned exp = 10 + random.below(21), velocity_exp = exp - random.below(9);
  const auto size = static_cast<std::int32_t>((1u << (exp - 7)) + random.below(1u << (exp - 7)));  // 8 to 16 mm
  const Block mesh = block(nx, ny, nz, size);
  ElasticItem item{{.shape = mesh.shape}, standing(mesh)};
  RawBody& body = *item.body;
  const auto part = [&] { return (1 + random.below(1000)) * 0.001; };
  const auto some = [&](std::initializer_list<double> of) {  // operands have no order
    const double whole = of.begin()[random.below(static_cast<std::uint32_t>(of.size()))];
    return part() * whole;
  };
  body.materials.clear();
  for (std::uint32_t m = 1 + random.below(3); m > 0; --m) {
    const double young = some({1e3, 1e4, 1e5}), poisson = part() * 1.4 - 0.91, density = some({1e3, 1e4});
    body.materials.push_back({young, poisson, density});
  }
  for (std::uint64_t left = mesh.tets.size(); body.materials.size() > 1 && left > 0; left -= body.lengths.back().first) {
    const std::uint64_t length = std::min<std::uint64_t>(left, 1 + random.below(9));  // arguments have no order
    const std::uint32_t material = random.below(static_cast<std::uint32_t>(body.materials.size()));
    body.lengths.emplace_back(length, static_cast<std::uint8_t>(material));
  }
  const bool has_weight = random.below(3) == 0;
  body.constants = {some({0, 10, 100}), some({0, 0.001, 0.03}), 0, 0, 0, some({50, 500, 5000}), some({0, 0.5, 3})};
  for (std::size_t axis = kGravityX; axis <= kGravityZ && has_weight; ++axis) body.constants[axis] = (part() - 0.5) * 20;
  const std::uint32_t ticks = 1 + random.below(20);
  RawHeader header = scene(item, ticks);
  header.tick_rate = 1 + random.below(random.below(4) == 0 ? 100 : 3000);
  header.grid.position = static_cast<std::uint8_t>(exp);
  header.grid.velocity = static_cast<std::uint8_t>(velocity_exp);

  ElasticStream stream(header);
  const std::array<int, 3> cells{nx, ny, nz};
  const auto place = [&] {  // from a quarter of a cell within the side to as much beyond it; above the ground
    Vec3i out{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      out[axis] = static_cast<std::int32_t>(random.below(static_cast<std::uint32_t>(cells[axis] * size + size / 2))) -
                  (axis < 2 ? size / 4 : 0);
    return out;
  };
  const std::int64_t frames = nx * ny * nz < 3 ? 60 : 30, end = frames * ticks;
  Vec3i from = place();
  from[2] = (nz * size * 9) / 8;
  bool key = true;
  for (std::int64_t tick = 0; tick < end;) {
    const std::int64_t time = 1 + std::int64_t{random.below(7 * ticks)};
    const Vec3i to = place();
    Vec3i velocity{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      velocity[axis] = static_cast<std::int32_t>(std::clamp<std::int64_t>(
          (std::int64_t{to[axis] - from[axis]} * header.tick_rate / time) >> (exp - velocity_exp), -(1 << 28), 1 << 28));
    stream.device(tick, from, velocity);
    if (key || random.below(3) == 0) {
      MainStep step{.at = {.tick = tick, .key = key},
                    .following = static_cast<Following>(random.below(8) == 0 ? 0 : 1 + random.below(2))};
      if (random.below(2) == 0) step.residuals = random_residuals(random, 5, 100);
      stream.add(0, step);
      key = false;
    }
    from = to;
    tick += time;
  }
  return stream.add(0, {.at = {.tick = end}, .following = Following::kept}).finished();
}

void add_shown(Catalogue& c) {
  c.section(section::kShown);
  add_device(c, "elastic", "A device presses on a body, slides over it and leaves; what is shown follows it.", pressed(pad()));
  add_device(c, "elastic-in-turn", "The same; packets follow, fading or kept, or do not.", pressed(pad(), mixed));
  add_device(c, "elastic-not-told", "The same; no packet follows.",
             pressed(pad(), {{3, Following::none, 5}, {60, Following::none, 5}}));
  c.valid("elastic-unknown", "What a client without a device shows of it.", pressed(pad(), mixed), {}, "none");
  c.valid("elastic-unknown-playout", "The same in the way playout.", pressed(pad(), mixed), {}, "playout");
  add_device(c, "elastic-frames-of-1-tick", "Frames of one tick.",
             played(scene(pad(1, 1, 1), 1), over({4 * kMm, 4 * kMm, kSize}), mixed, 160));
  add_device(c, "elastic-frames-of-20-ticks", "Frames of 20 ticks; packets come between their ends.", pressed(pad(), mixed, 20));
  add_device(c, "elastic-fades-away", "What differs fades to 0; then it is kept, and is limited.", faded());
  add_device(c, "elastic-old-state", "A state that is kept for 100 frames.",
             played(scene(pad(1, 1, 1), 1), over({4 * kMm, 4 * kMm, kSize}), {{0}, {40, Following::kept, 5}}, 140));
  add_device(c, "elastic-late-device", "The device is told of at tick 40.", [] {
    std::vector<Move> moves = over(kTop);
    moves.erase(moves.begin());
    return played(scene(pad(), 5), moves, fades, 150);
  }());
  add_device(c, "elastic-overtaken", "A packet of the device that another one of the same tick has overtaken.", overtaken());
  add_device(c, "elastic-several", "Two bodies, one with a push and weight, a sheet, and a driven rigid object, eased.",
             several());
}

void add_touches(Catalogue& c) {
  c.section(section::kTouch);
  add_device(c, "elastic-friction", "Friction holds the proxy, and lets it slide behind the device.",
             pressed(changed([](RawDeformable&, RawBody& b) { b.constants[kFriction] = 0.4; })));
  add_device(c, "elastic-rough", "Friction holds the proxy where it touched first.",
             pressed(changed([](RawDeformable&, RawBody& b) { b.constants[kFriction] = 1e15; })));
  add_device(c, "elastic-odd-triangles", "Triangles that do not cover the surface, cross the inside, lie twice or have no area.",
             pressed(odd_triangles()));
  add_device(c, "elastic-odd-and-rough", "The same with friction.",
             pressed(changed([](RawDeformable&, RawBody& b) { b.constants[kFriction] = 0.7; }, odd_triangles()), mixed));
  add_device(c, "elastic-swept", "A device that crosses several triangles in a tick.", swept(0));
  add_device(c, "elastic-swept-and-rough", "The same with friction: the proxy comes after it.", swept(0.8));
  add_device(c, "elastic-no-triangles", "A body without a surface, which has weight.",
             pressed(changed([](RawDeformable& o, RawBody& b) {
               o.shape.triangles.clear();
               b.constants[kGravityZ] = -9.81;
             })));
}

void add_steps(Catalogue& c) {
  c.section(section::kStep);
  add_device(c, "elastic-with-inner", "An inner vertex, two materials and friction.",
             played(scene(with_inner(), 8), over({7 * kMm, 8 * kMm, 2 * kSize}), mixed, 190));
  add_device(c, "elastic-weight", "A body that sways by its weight, and is pressed upon.",
             pressed(changed([](RawDeformable&, RawBody& b) {
                       b.constants[kGravityX] = 40;
                       b.constants[kGravityZ] = -9.81;
                     }),
                     mixed));
  add_device(c, "elastic-falls", "A body that nothing holds falls, and the device is in its way.",
             played(scene(changed(
                              [](RawDeformable&, RawBody& b) {
                                b.runs.clear();
                                b.constants[kGravityZ] = -9.81;
                                b.constants[kMassDamping] = 0;
                                b.constants[kCoupling] = 8;
                              },
                              pad(1, 1, 1)),
                          5),
                    {{0, {4 * kMm, 6 * kMm, -6 * kMm}}}, fades, 160));
  add_device(c, "elastic-turns-over", "A soft body that the device pushes over and turns.",
             played(scene(changed(
                              [](RawDeformable&, RawBody& b) {
                                b.runs = {{0, 0}};
                                b.materials = {{3000, 0.2, 500}};
                                b.constants[kFriction] = 1;
                                b.constants[kCoupling] = 10;
                              },
                              pad(1, 1, 1)),
                          5),
                    {{0, {9 * kMm, 5 * kMm, 11 * kMm}, {0, 0, -100 * kSpeed}},
                     {40, {9 * kMm, 5 * kMm, 7 * kMm}, {-400 * kSpeed, 0, -100 * kSpeed}},
                     {100, {-15 * kMm, 5 * kMm, kMm}, {0, 300 * kSpeed, 200 * kSpeed}}},
                    mixed, 160));
  add_device(c, "elastic-alone", "No object moves: no device, but weight.",
             played(scene(changed([](RawDeformable&, RawBody& b) { b.constants[kGravityY] = 9.81; }), 5, false), {},
                    {{3, Following::fading, 5}, {50, Following::kept, 5}}, 150));
  const char* ends = "A body that ends: what is shown does not follow the device any more.";
  add_device(c, "elastic-ends-by-coupling", ends,
             pressed(changed([](RawDeformable&, RawBody& b) { b.constants[kCoupling] = 1e12; }), mixed));
  add_device(c, "elastic-ends-by-weight", ends,
             pressed(changed([](RawDeformable&, RawBody& b) { b.constants[kGravityX] = 1e12; }), mixed));
  add_device(c, "elastic-next-to-nothing", "The least stiffness and density: no step finds a way.",
             pressed(changed([](RawDeformable&, RawBody& b) {
                       b.materials = {{5e-324, 0.4, 5e-324}};
                     }),
                     mixed));
}

void add_others(Catalogue& c) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u, 9u, 10u, 11u, 12u})
    add_device(c, "elastic-" + std::to_string(seed), "Any body, materials, constants, clock and way of the device.",
               any(920 + seed));
  const auto damped = [](RawDeformable&, RawBody& b) {
    b.constants[kMassDamping] = 200;
    b.constants[kStiffnessDamping] = 0.1;
  };
  const Vec3i above{4 * kMm, 4 * kMm, kSize + kMm}, below{4 * kMm, 4 * kMm, kSize - 3 * kMm};
  add_device(c, "elastic-let-go", "The device holds the body until it is still, and leaves: the dent goes.",
             played(scene(changed(damped, pad(1, 1, 1)), 20), {{0, above}, {30, below}, {2600, above}}, fades, 3000));
  add_device(
      c, "elastic-not-followed", "No packet follows for 80 frames; then one does.",
      played(scene(pad(1, 1, 1), 1), over({4 * kMm, 4 * kMm, kSize}), {{2, Following::none, 5}, {83, Following::kept, 5}}, 160));
  add_device(c, "elastic-after-the-end", "A body that has ended, 80 frames later.",
             played(scene(changed([](RawDeformable&, RawBody& b) { b.constants[kCoupling] = 1e12; }, pad(1, 1, 1)), 1),
                    over({4 * kMm, 4 * kMm, kSize}), mixed, 190));
  add_device(c, "elastic-deep", "In one tick the device goes deeper than half of the body, and comes out below.",
             played(scene(pad(1, 1, 1), 5), {{0, above}, {31, {4 * kMm, 5 * kMm, 3 * kMm}}, {90, {4 * kMm, 5 * kMm, -4 * kMm}}},
                    fades, 150));
  add_device(c, "elastic-first-triangle-of-no-area", "The first triangle has no nearest point.",
             pressed(changed([](RawDeformable& o, RawBody& b) {
               const std::size_t copy = o.shape.rest.size();  // fixed, and in no tetrahedron
               o.shape.rest.push_back(o.shape.rest[0]);
               o.shape.triangles.insert(o.shape.triangles.begin(), {0, static_cast<std::uint32_t>(copy), 1});
               std::uint64_t end = 0;
               for (const auto& [gap, more] : b.runs) end += gap + more + 1;
               b.runs.push_back({copy - end, 0});
             })));
}

}  // namespace

void add_client_elastic(Catalogue& c) {
  add_shown(c);
  add_touches(c);
  add_steps(c);
  add_others(c);
}

}  // namespace tactus::conformance
