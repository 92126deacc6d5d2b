// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <tactus/sim/random.h>
#include <tactus/sim/rigid/rigid_world.h>
#include "lab/study/sampled_mass.h"
#include "lab/study/stability.h"

namespace tactus::sim::study {
namespace {

constexpr double kGravity = 9.81, kFriction = 0.5;
constexpr Vec3 kCube{0.04, 0.04, 0.04};

Scene table() {
  Scene scene;
  scene.gravity = {0, 0, -kGravity};
  scene.floor = 0.0;
  return scene;
}

void add(Scene& scene, const Vec3& size, double mass, const Vec3& position) {
  SceneObject object;
  object.name = "block" + std::to_string(scene.objects.size());
  object.size = size;
  object.mass = mass;
  object.friction = kFriction;
  object.pose.position = position;
  scene.objects.push_back(std::move(object));
}

/// 18 layers of three blocks, 0.2 mm apart, each layer across the one below.
Scene tower() {
  constexpr double kPitch = 25.2e-3, kHeight = 15e-3, kMass = 14e-3;
  Scene scene = table();
  for (int layer = 0; layer < 18; ++layer) {
    const double height = (layer + 0.5) * kHeight;
    for (int column = -1; column <= 1; ++column) {
      if (layer % 2 == 0) add(scene, {75e-3, 25e-3, kHeight}, kMass, {0, column * kPitch, height});
      else add(scene, {25e-3, 75e-3, kHeight}, kMass, {column * kPitch, 0, height});
    }
  }
  return scene;
}

Scene stack(double top_mass_ratio) {
  constexpr int kCubes = 10;
  Scene scene = table();
  for (int i = 0; i < kCubes; ++i) add(scene, kCube, i + 1 == kCubes ? 0.15 * top_mass_ratio : 0.15, {0, 0, (i + 0.5) * kCube.z});
  return scene;
}

/// Farthest that any object's centre is from where it was [m].
double farthest(const RigidWorld& world, std::span<const Vec3> from) {
  double out = 0;
  for (std::uint32_t i = 0; i < from.size(); ++i) out = std::max(out, norm(world.sample(i).pose.position - from[i]));
  return out;
}

std::vector<Vec3> positions(const RigidWorld& world, std::size_t objects) {
  std::vector<Vec3> out;
  for (std::uint32_t i = 0; i < objects; ++i) out.push_back(world.sample(i).pose.position);
  return out;
}

bool stands_still(const RigidWorld& world, std::size_t objects) {
  for (std::uint32_t i = 0; i < objects; ++i)
    if (const RigidSample s = world.sample(i); s.velocity != Vec3{} || s.angular_velocity != Vec3{}) return false;
  return true;
}

enum class Sleep : std::uint8_t { allowed, prevented };

/// How far a block moves after the first second, in which the tower settles.
Row tower_row(double seconds, Sleep sleep, const Progress& progress) {
  const Scene scene = tower();
  RigidWorld world(scene);
  Row row{.subject = "tower of 54 blocks", .quantity = "creep after 1 s", .unit = "mm"};
  row.parameters = {{"for", seconds, "s"}};
  const std::int64_t ticks = std::llround(seconds / kTick);
  std::vector<Vec3> settled;
  std::optional<double> asleep;  // [s]
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    if (tick % 100 == 0) progress("rigid, tower", static_cast<std::uint64_t>(tick), static_cast<std::uint64_t>(ticks));
    // A negligible force keeps the pile awake.
    if (sleep == Sleep::prevented) world.push(0, {0, 0, -1e-12}, scene.objects[0].pose.position);
    if (const auto step = world.step(); !step) {
      row.verdict = Verdict::diverges;
      row.remark = to_string(step.error());
      return row;
    }
    if (!asleep && stands_still(world, scene.objects.size())) asleep = static_cast<double>(world.tick()) * kTick;
    if (world.tick() == 1000) settled = positions(world, scene.objects.size());
  }
  row.measured = 1e3 * farthest(world, settled);
  row.verdict = *row.measured < 1 ? Verdict::stable : Verdict::diverges;
  row.remark = asleep ? "sleeps from " + std::to_string(std::llround(1e3 * *asleep)) + " ms on" : "kept awake";
  return row;
}

Row stack_row(double ratio, double seconds) {
  const Scene scene = stack(ratio);
  RigidWorld world(scene);
  Row row{.subject = "stack of 10 cubes", .quantity = "top sinks", .unit = "mm"};
  row.parameters = {{"top mass ratio", ratio, ""}, {"for", seconds, "s"}};
  for (std::int64_t tick = 0; tick < std::llround(seconds / kTick); ++tick) {
    if (const auto step = world.step(); !step) {
      row.verdict = Verdict::diverges;
      row.remark = to_string(step.error());
      return row;
    }
  }
  const Vec3 moved = world.sample(9).pose.position - scene.objects[9].pose.position;
  row.measured = -1e3 * moved.z;
  const bool stands = std::hypot(moved.x, moved.y) < kCube.x / 2 && std::abs(moved.z) < kCube.z / 2;
  row.verdict = stands ? Verdict::stable : Verdict::diverges;
  row.remark = stands ? "" : "collapses";
  return row;
}

// A cube on a rail, tied by a spring to a probe that stands still. The force is computed every `every` ticks and held.
constexpr double kRailMass = 0.15;

struct Rail {
  double damping = 1;  // factor on the velocity every tick, d of the scene
  int every = 1;       // ticks
};

/// Position, velocity and force after `every` ticks of RigidWorld: v += h f / m, x += h v, v *= d.
Transition transition(const Rail& rail) {
  const auto advance = [&](double x, double v, double f) {
    for (int i = 0; i < rail.every; ++i) {
      v += kTick * f / kRailMass;
      x += kTick * v;
      v *= rail.damping;
    }
    return std::array{x, v};
  };
  const auto x = advance(1, 0, 0), v = advance(0, 1, 0), f = advance(0, 0, 1);
  return {.state = {{{x[0], v[0]}, {x[1], v[1]}}}, .force = f};
}

Verdict touch(double stiffness, const Rail& rail) {
  Scene scene;
  add(scene, kCube, kRailMass, {1e-3, 0, 0});
  scene.objects[0].dof = Dof::x;
  scene.objects[0].damping = rail.damping;
  RigidWorld world(scene);
  constexpr int kTicks = 40'000;
  double force = 0, early = 0, late = 0;
  for (int tick = 0; tick < kTicks; ++tick) {
    const Vec3 cube = world.sample(0).pose.position;
    if (tick % rail.every == 0) force = -stiffness * cube.x;
    world.push(0, {force, 0, 0}, cube);
    if (!world.step()) return Verdict::diverges;
    if (tick < kTicks / 4) early = std::max(early, std::abs(cube.x));
    if (tick >= kTicks - kTicks / 4) late = std::max(late, std::abs(cube.x));
  }
  return late > 1.02 * early ? Verdict::diverges : late > early / 2 ? Verdict::limit : Verdict::stable;
}

void touch_rows(Study& study, Extent extent) {
  const std::string subject = "stiff touch of a 150 g cube";
  const auto parameters = [](const Rail& rail) {
    return std::vector<Parameter>{{"rate", 1000.0 / rail.every, "Hz"}, {"d", rail.damping, ""}};
  };
  for (const Rail& rail : {Rail{1, 1}, Rail{0.999, 1}, Rail{0.999, 17}}) {
    Row row{
        .subject = subject, .parameters = parameters(rail), .verdict = Verdict::limit, .quantity = "largest k", .unit = "N/m"};
    row.measured = bisect(1, 1e7, 1e-4, [&](double k) { return touch(k, rail) != Verdict::diverges; });
    row.analytic = largest_spring(transition(rail));
    study.rows.push_back(row);
  }
  for (const Rail& rail : {Rail{0.999, 1}, Rail{0.999, 17}})
    for (const double k : extent == Extent::full ? std::vector<double>{500, 1e4, 1e5, 5e5, 1e6} : std::vector<double>{500, 1e6}) {
      Row row{.subject = subject, .parameters = parameters(rail), .verdict = touch(k, rail), .quantity = "fraction of the limit"};
      row.parameters.push_back({"k", k, "N/m"});
      row.measured = k / largest_spring(transition(rail));
      study.rows.push_back(row);
    }
}

/// Largest deviation of the deceleration of a sliding cube from mu g over directions of motion.
Row friction_row(Extent extent) {
  const int directions = extent == Extent::full ? 12 : 4;
  const double step = 90.0 / directions;
  Row row{.subject = "sliding cube, 0 to 90 degrees", .quantity = "friction off by", .unit = "%"};
  row.parameters = {{"in steps of", step, "deg"}};
  double worst = 0;
  for (int i = 0; i <= directions; ++i) {
    const double angle = i * step * std::numbers::pi / 180;
    const Vec3 direction{std::cos(angle), std::sin(angle), 0};
    Scene scene = table();
    add(scene, kCube, 0.15, {0, 0, kCube.z / 2});
    RigidWorld world(scene);
    const auto run = [&](int ticks, const Vec3& force) {
      for (int tick = 0; tick < ticks; ++tick) {
        world.push(0, force, world.sample(0).pose.position);
        if (!world.step()) worst = std::numeric_limits<double>::infinity();
      }
      return norm(world.sample(0).velocity);
    };
    run(20, (0.15 * (kFriction * kGravity + 50)) * direction);
    const double before = run(1, {}), after = run(100, {});  // the push ends in the first
    worst = std::max(worst, std::abs((before - after) / 0.1 / (kFriction * kGravity) - 1));
  }
  row.measured = 100 * worst;
  row.verdict = worst < 0.01 ? Verdict::stable : Verdict::diverges;
  row.remark = "a friction pyramid is 41 % off at 45 degrees";
  return row;
}

/// A heap of cubes that fall on each other, with turns from a seed.
std::vector<RigidSample> heap(int ticks) {
  Scene scene = table();
  Random random(11);
  for (int i = 0; i < 12; ++i) {
    add(scene, kCube, 0.15, {random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03), 0.05 + 0.06 * i});
    const double half = random.uniform(0, 1.5);
    scene.objects.back().pose.rotation = {std::cos(half), std::sin(half) * 0.6, std::sin(half) * 0.8, 0};
  }
  RigidWorld world(scene);
  for (int i = 0; i < ticks; ++i)
    if (!world.step()) return {};
  std::vector<RigidSample> out;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) out.push_back(world.sample(i));
  return out;
}

bool is_same(const RigidSample& a, const RigidSample& b) {
  return a.pose.position == b.pose.position && a.pose.rotation == b.pose.rotation && a.velocity == b.velocity &&
         a.angular_velocity == b.angular_velocity;
}

Row repeat_row() {
  Row row{.subject = "heap of 12 falling cubes, twice", .quantity = "states that differ"};
  const auto first = heap(800), second = heap(800);
  std::size_t different = first.empty() ? 12 : 0;
  for (std::size_t i = 0; i < first.size(); ++i) different += is_same(first[i], second[i]) ? 0u : 1u;
  row.measured = static_cast<double>(different);
  row.verdict = different == 0 ? Verdict::stable : Verdict::diverges;
  row.remark = "every number, after 0.8 s";
  return row;
}

Row refusal_row() {
  Row row{.subject = "pushed with NaN, infinity, 1e300 N, 1e8 N", .verdict = Verdict::diverges, .quantity = "steps refused"};
  int refused = 0;
  for (const double force : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300, 1e8}) {
    Scene scene = table();
    add(scene, kCube, 0.15, {0, 0, kCube.z / 2});
    RigidWorld world(scene);
    world.push(0, {force, 0, 0}, {0, 0, kCube.z});
    if (const auto step = world.step(); !step) {
      ++refused;
      row.remark = to_string(step.error());
    }
  }
  row.measured = refused;
  row.analytic = 4;
  return row;
}

}  // namespace

Study study_rigid(Extent extent, const Progress& progress) {
  const bool full = extent == Extent::full;
  Study study{.name = "rigid", .title = "Rigid objects"};
  study.text =
      "`RigidWorld` (ODE at 1 kHz: QuickStep with 100 iterations, where they leave more than 2 mm/s the direct solver or 1000). "
      "Blocks of 75 x 25 x 15 mm and 14 g, cubes of 4 cm and 150 g, "
      "friction 0.5. A pile sleeps when no point of it has moved 20 um in 256 ms, until it is pushed or hit; the tower is shown "
      "with and without sleep. *Stiff touch*: a spring ties a cube on a rail to a probe that stands still. The spring's force "
      "is computed every tick or, at 60 Hz, every 17th tick, and held. Mass ratios are reported as limits, not guaranteed. "
      "*Unsolved*: "
      "steps that left more than 2 mm/s all the same; `tactus sim` warns of them.";
  study.rows.push_back(tower_row(full ? 600 : 2, Sleep::allowed, progress));
  if (full) study.rows.push_back(tower_row(11, Sleep::prevented, progress));
  const std::vector<double> ratios = full ? std::vector<double>{1, 3, 10, 30, 100, 1e3, 1e4} : std::vector<double>{1, 100};
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    progress("rigid, stacks", i, ratios.size());
    study.rows.push_back(stack_row(ratios[i], full ? 3 : 0.5));
  }
  progress("rigid, touch", 0, 1);
  touch_rows(study, extent);
  study.rows.push_back(friction_row(extent));
  study.rows.push_back(repeat_row());
  study.rows.push_back(refusal_row());
  add_motion_rows(study, extent, progress);
  return study;
}

}  // namespace tactus::sim::study
