// SPDX-License-Identifier: Apache-2.0
/// Cost of an elastic body at one end of a session: a step, a tick of the touch, a shape that is shown. Beside it the simulation's own step
/// of the same membrane, which is solved to the end.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include <tactus/deformable/main_state.h>
#include <tactus/elastic/driven_shape.h>
#include <tactus/rigid/device_path.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/sim/deformable/deformable_body.h>
#include <tactus/sim/deformable/elastic_physics.h>
#include <tactus/sim/scene/scene.h>

namespace tactus {
namespace {

const sim::Scene& membrane() {
  static const sim::Scene scene = sim::load_scene(*sim::find_scene("membrane-large")).value();
  return scene;
}

SharedScene declared() {
  const sim::SceneDeformable& object = membrane().deformables[0];
  SceneBuilder builder;
  const auto frame = static_cast<double>(object.rate);
  builder.deformable("membrane", sim::surface(object.mesh).mesh,
                     {.frame_period = frame, .elastic = sim::elastic_physics(object, membrane().gravity, {}).value()});
  builder.baselines(64);
  return builder.build().value();
}

constexpr double kPush = -0.03;  // [N]

void set_up(benchmark::State& state) {
  const SharedScene scene = declared();
  for (auto _ : state) benchmark::DoNotOptimize(ElasticSolver(*scene, scene->deformables[0]).vertices());
}
BENCHMARK(set_up)->Unit(benchmark::kMillisecond);

/// The push goes round, so that the body never rests.
void step(benchmark::State& state) {
  const SharedScene scene = declared();
  ElasticSolver solver(*scene, scene->deformables[0]);
  ElasticState shape(solver.vertices());
  std::vector<double> load(shape.displacement.size());
  std::size_t at = 0;
  for (auto _ : state) {
    load[3 * at + 2] = 0;
    at = (at + 1) % solver.vertices();
    load[3 * at + 2] = kPush;
    benchmark::DoNotOptimize(solver.step(load, shape));
  }
}
BENCHMARK(step)->Unit(benchmark::kMicrosecond);

void step_of_the_simulation(benchmark::State& state) {
  auto body = sim::DeformableBody::create(membrane().deformables[0], membrane().gravity, 0).value();
  const std::size_t triangles = body->surface().mesh.triangles.size();
  std::size_t at = 0;
  for (auto _ : state) {
    at = (at + 1) % triangles;
    auto done = sim::DeformableBody::Tick::between;
    while (done == sim::DeformableBody::Tick::between) {
      body->push(static_cast<std::uint32_t>(at), std::array{1.0, 0.0, 0.0}, {0, 0, kPush});
      done = body->tick().value();
    }
    body->show();
  }
}
BENCHMARK(step_of_the_simulation)->Unit(benchmark::kMicrosecond);

void touch(benchmark::State& state) {
  const SharedScene scene = declared();
  const DeformableObject& object = scene->deformables[0];
  const ElasticTouch touch(object);
  std::vector<Vec3> surface;
  for (const Vec3i& p : object.rest) surface.push_back({std::ldexp(p[0], -22), std::ldexp(p[1], -22), std::ldexp(p[2], -22)});
  ElasticTouch::State proxy;
  touch.move({0, 0, 1e-3}, true, surface, proxy);
  double angle = 0;
  for (auto _ : state) {
    angle += 2e-3;
    benchmark::DoNotOptimize(touch.move({0.02 * std::cos(angle), 0.02 * std::sin(angle), -1e-3}, false, surface, proxy));
  }
}
BENCHMARK(touch);

/// What an end does in a tick while nothing is touched and no shape is new: it looks.
void show_at_rest(benchmark::State& state) {
  const SharedScene scene = declared();
  DevicePath path(device_scene(*scene).value());
  path.shift(0, 0);
  DrivenShape shape(*scene, scene->deformables[0], path);
  MainState of = initial_main_state(scene->deformables[0]);
  of.following = Following::fading;
  std::vector<Vec3i> shown(of.displacement.size());
  std::int64_t tick = 0;
  for (auto _ : state) benchmark::DoNotOptimize(shape.show(of, tick += 17, shown));
}
BENCHMARK(show_at_rest)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace tactus
