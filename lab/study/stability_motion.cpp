// SPDX-License-Identifier: Apache-2.0
// Free rotation, falls, masses that differ, walls, a cradle, an hour of rest.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <tactus/sim/rigid/rigid_world.h>
#include "lab/study/stability.h"

namespace tactus::sim::study {
namespace {

constexpr double kGravity = 9.81;

Scene nowhere() { return Scene{}; }

Scene table() {
  Scene scene;
  scene.gravity = {0, 0, -kGravity};
  scene.floor = 0.0;
  return scene;
}

SceneObject& add(Scene& scene, const Vec3& size, double mass, const Vec3& position) {
  SceneObject object;
  object.name = "block" + std::to_string(scene.objects.size());
  object.size = size;
  object.mass = mass;
  object.friction = 0.5;
  object.pose.position = position;
  scene.objects.push_back(std::move(object));
  return scene.objects.back();
}

/// False if it broke down.
bool run(RigidWorld& world, double seconds) {
  for (std::int64_t tick = 0; tick < std::llround(seconds / kTick); ++tick)
    if (!world.step()) return false;
  return true;
}

/// A box spun about its middle axis, 1 % off: how much its energy changes.
Row spin_row(double speed, double seconds) {
  Scene scene = nowhere();
  add(scene, {0.02, 0.06, 0.12}, 0.15, {}).angular_velocity = {0.01 * speed, speed, 0.003 * speed};
  RigidWorld world(scene);
  Row row{.subject = "free box about its middle axis", .quantity = "energy changes by", .unit = "J/J"};
  row.parameters = {{"speed", speed, "rad/s"}, {"for", seconds, "s"}};
  const Vec3 inertia = world.inertia(0), w = scene.objects[0].angular_velocity;
  const double energy = (inertia.x * w.x * w.x + inertia.y * w.y * w.y + inertia.z * w.z * w.z) / 2;
  const bool done = run(world, seconds);
  row.measured = world.errors().flight.value / energy;
  row.verdict = done && *row.measured < 1e-4 ? Verdict::stable : Verdict::diverges;
  return row;
}

/// Farthest from x = -g t^2 / 2 at the end of a tick.
Row fall_row() {
  Scene scene = nowhere();
  scene.gravity = {0, 0, -kGravity};
  add(scene, {0.04, 0.04, 0.04}, 0.15, {});
  RigidWorld world(scene);
  Row row{.subject = "free fall", .quantity = "off by", .unit = "m"};
  row.parameters = {{"for", 1, "s"}};
  double most = 0;
  for (int tick = 1; tick <= 1000; ++tick) {
    if (!world.step()) return row;
    const double t = tick * kTick;
    most = std::max(most, std::abs(world.sample(0).pose.position.z + kGravity * t * t / 2));
  }
  row.measured = most;
  row.verdict = most < 1e-9 ? Verdict::stable : Verdict::diverges;
  return row;
}

/// A heavy cube on a light one.
Row pair_row(double ratio, double seconds) {
  Scene scene = table();
  add(scene, {0.04, 0.04, 0.04}, 0.15, {0, 0, 0.02});
  add(scene, {0.04, 0.04, 0.04}, 0.15 * ratio, {0, 0, 0.06});
  RigidWorld world(scene);
  Row row{.subject = "cube on a cube", .quantity = "top sinks", .unit = "mm"};
  row.parameters = {{"top mass ratio", ratio, ""}, {"for", seconds, "s"}};
  const bool done = run(world, seconds);
  row.measured = 1e3 * (0.06 - world.sample(1).pose.position.z);
  row.verdict = done && std::abs(*row.measured) < 1 ? Verdict::stable : Verdict::diverges;
  const RigidErrors& errors = world.errors();
  row.remark = std::to_string(errors.unsolved) + " of " + std::to_string(errors.steps) + " steps unsolved";
  return row;
}

Row wall_row(double speed, int phases) {
  Row row{.subject = "1 cm cube against a wall of 1 mm", .quantity = "passes", .unit = "of " + std::to_string(phases)};
  row.parameters = {{"speed", speed, "m/s"}};
  int through = 0;
  for (int phase = 0; phase < phases; ++phase) {
    Scene scene = nowhere();
    add(scene, {1e-3, 1, 1}, 1, {}).dof = Dof::none;
    add(scene, {0.01, 0.01, 0.01}, 0.01, {-0.2 - speed * kTick * phase / phases, 0, 0}).velocity = {speed, 0, 0};
    RigidWorld world(scene);
    if (!run(world, 0.3) || world.sample(1).pose.position.x > 0) ++through;
  }
  row.measured = through;
  row.verdict = through == 0 ? Verdict::stable : Verdict::diverges;
  return row;
}

/// Newton's cradle without restitution: all move on together.
Row cradle_row() {
  Scene scene = nowhere();
  for (int i = 0; i < 5; ++i) add(scene, {0.04, 0.04, 0.04}, 0.15, {(i == 0 ? -0.02 : 0.0) + 0.04 * i, 0, 0}).friction = 0;
  scene.objects[0].velocity = {1, 0, 0};
  RigidWorld world(scene);
  Row row{.subject = "cube hits four in a row", .quantity = "energy left, of 75; plastic 15", .unit = "mJ"};
  const bool done = run(world, 0.5);
  double energy = 0, momentum = 0;
  for (std::uint32_t i = 0; i < 5; ++i) {
    const Vec3 v = world.sample(i).velocity;
    energy += 0.15 * dot(v, v) / 2;
    momentum += 0.15 * v.x;
  }
  row.measured = 1e3 * energy;
  row.verdict = done && std::abs(momentum - 0.15) < 1e-9 ? Verdict::stable : Verdict::diverges;
  return row;
}

/// Below the friction angle, kept awake by a negligible push.
Row rest_row(double seconds) {
  const double angle = 26 * std::numbers::pi / 180;
  Scene scene = table();
  scene.gravity = kGravity * Vec3{std::sin(angle), 0, -std::cos(angle)};
  add(scene, {0.1, 0.1, 0.02}, 0.15, {0, 0, 0.01});
  RigidWorld world(scene);
  Row row{.subject = "plate on a slope of 26 degrees, limit 26.565", .quantity = "creeps", .unit = "mm"};
  row.parameters = {{"for", seconds, "s"}};
  for (std::int64_t tick = 0; tick < std::llround(seconds / kTick); ++tick) {
    if (tick % 2 == 0) world.push(0, {0, 0, -1e-9}, world.sample(0).pose.position);
    if (!world.step()) return row;
  }
  row.measured = 1e3 * norm(world.sample(0).pose.position - scene.objects[0].pose.position);
  row.verdict = *row.measured < 1e-3 ? Verdict::stable : Verdict::diverges;
  return row;
}

}  // namespace

void add_motion_rows(Study& study, Extent extent, const Progress& progress) {
  const bool full = extent == Extent::full;
  study.rows.push_back(fall_row());
  for (const double speed : {2.0, 10.0, 50.0, 200.0}) study.rows.push_back(spin_row(speed, full ? 60 : 2));
  for (const double ratio : {1e2, 1e3, 1e4, 1e5, 1e6}) study.rows.push_back(pair_row(ratio, full ? 5 : 0.5));
  for (const double speed : {8.0, 20.0, 100.0}) study.rows.push_back(wall_row(speed, full ? 40 : 4));
  study.rows.push_back(cradle_row());
  progress("rigid, rest", 0, 1);
  study.rows.push_back(rest_row(full ? 3600 : 2));
}

}  // namespace tactus::sim::study
