// SPDX-License-Identifier: Apache-2.0
#include "lab/study/precision_rigid.h"

#include <array>
#include <cmath>
#include <limits>

#include "lab/study/precision.h"

namespace tactus::sim::study {
namespace {

constexpr double kGravity = 9.81, kFriction = 0.5;
constexpr double kStopped = std::numeric_limits<double>::infinity();
constexpr RigidEffort kReference{.parts = 64, .iterations = 400};

SceneObject block(const Vec3& size, double mass, const Vec3& position) {
  SceneObject out;
  out.name = "block";
  out.size = size;
  out.mass = mass;
  out.friction = kFriction;
  out.pose.position = position;
  return out;
}

Scene on_a_floor() {
  Scene scene;
  scene.gravity = {0, 0, -kGravity};
  scene.floor = 0.0;
  return scene;
}

/// State of the last object after some ticks; what a tick cost.
struct Outcome {
  RigidSample last;
  double seconds_per_tick = 0;
  bool done = false;
};

Outcome run(const Scene& scene, const RigidEffort& effort, int ticks) {
  RigidWorld world(scene, effort);
  const double start = processor_seconds();
  int tick = 0;
  while (tick < ticks && world.step()) ++tick;
  return {world.sample(static_cast<std::uint32_t>(scene.objects.size() - 1)), (processor_seconds() - start) / ticks,
          tick == ticks};
}

double turned(const Scene& scene, const RigidEffort& effort, int ticks, double& seconds) {
  const Outcome made = run(scene, effort, ticks), reference = run(scene, kReference, ticks);
  seconds = made.seconds_per_tick;
  return made.done ? angle_between(made.last.pose.rotation, reference.last.pose.rotation) : kStopped;
}

double free_rotation(const RigidEffort& effort, double& seconds) {
  Scene scene;
  scene.objects.push_back(block({0.02, 0.06, 0.12}, 0.15, {}));
  scene.objects[0].angular_velocity = {0.5, 50, 0.15};
  return turned(scene, effort, 1000, seconds);
}

double tipping(const RigidEffort& effort, double& seconds) {
  Scene scene = on_a_floor();
  scene.objects.push_back(block({0.04, 0.04, 0.12}, 0.15, {0, 0, 0.06}));
  scene.objects[0].friction = 5;
  scene.objects[0].velocity = {0.55, 0, 0};
  scene.objects[0].angular_velocity = {0, 9, 0};
  return turned(scene, effort, 120, seconds);
}

double slide(const RigidEffort& effort, double& seconds) {
  Scene scene = on_a_floor();
  scene.objects.push_back(block({0.1, 0.1, 0.02}, 0.15, {0, 0, 0.01}));
  scene.objects[0].velocity = {0.997, 0, 0};
  const Outcome made = run(scene, effort, 400);
  seconds = made.seconds_per_tick;
  return made.done ? std::abs(made.last.pose.position.x - 0.997 * 0.997 / (2 * kFriction * kGravity)) : kStopped;
}

double bounce_free_landing(const RigidEffort& effort, double& seconds) {
  Scene scene = on_a_floor();
  scene.objects.push_back(block({0.04, 0.04, 0.04}, 0.15, {0, 0, 0.2203}));
  const Outcome made = run(scene, effort, 260);
  seconds = made.seconds_per_tick;
  return made.done ? std::abs(made.last.pose.position.z - 0.02) : kStopped;
}

double sinking(int cubes, double ratio, const RigidEffort& effort, double& seconds) {
  Scene scene = on_a_floor();
  for (int i = 0; i < cubes; ++i)
    scene.objects.push_back(block({0.04, 0.04, 0.04}, i + 1 == cubes ? 0.15 * ratio : 0.15, {0, 0, (i + 0.5) * 0.04}));
  const Vec3 start = scene.objects.back().pose.position;
  const Outcome made = run(scene, effort, 2000);
  seconds = made.seconds_per_tick;
  return made.done ? norm(made.last.pose.position - start) : kStopped;
}

double stack(const RigidEffort& effort, double& seconds) { return sinking(10, 1, effort, seconds); }
double pair(const RigidEffort& effort, double& seconds) { return sinking(2, 1e3, effort, seconds); }

constexpr std::array kMotions{
    RigidMotion{"free-rotation", "a free box at 50 rad/s about its middle axis, attitude after 1 s", "rad", free_rotation},
    RigidMotion{"tipping", "a box tips over an edge, attitude after 0.12 s", "rad", tipping},
    RigidMotion{"slide", "a plate slides from 1 m/s until it rests, distance", "m", slide},
    RigidMotion{"landing", "a cube falls 0.2 m, height 60 ms after it met the floor", "m", bounce_free_landing},
    RigidMotion{"stack", "ten cubes, displacement of the top one in 2 s", "m", stack},
    RigidMotion{"pair", "a cube on a cube of a thousandth of its mass, displacement of the top one in 2 s", "m", pair}};

}  // namespace

std::span<const RigidMotion> rigid_motions() noexcept { return kMotions; }

}  // namespace tactus::sim::study
