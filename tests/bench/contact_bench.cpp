// SPDX-License-Identifier: Apache-2.0
/// Collision and haptic rendering on meshes. A tick of one user is timed by itself: p50 and p99 [us] beside the 1 ms budget.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <vector>

#include <tactus/sim/contact/intermediate_model.h>
#include <tactus/sim/tets/tet_mesh.h>
#include "tests/unit/contact_mesh_fixture.h"

namespace tactus {
namespace {

using Clock = std::chrono::steady_clock;
using testing::Body;

class Samples {
 public:
  template <class Action>
  void time(benchmark::State& state, Action&& action) {
    const auto start = Clock::now();
    action();
    const std::chrono::duration<double> took = Clock::now() - start;
    state.SetIterationTime(took.count());
    us_.push_back(1e6 * took.count());
  }
  void report(benchmark::State& state) {
    if (us_.empty()) return;
    std::sort(us_.begin(), us_.end());
    const auto at = [this](double fraction) {
      return us_[static_cast<std::size_t>(fraction * static_cast<double>(us_.size() - 1))];
    };
    state.counters["p50_us"] = at(0.5);
    state.counters["p99_us"] = at(0.99);
    state.counters["p999_us"] = at(0.999);
    state.counters["max_us"] = us_.back();
  }

 private:
  std::vector<double> us_;
};

/// 100 352 triangles of 2 mm; bumps of 2 cm and 3 mm height, and roughness.
const Body& terrain() {
  static const Body body(testing::sheet(224, 0.002, [random = sim::Random(1)](double x, double y) mutable {
    return 0.003 * std::sin(300 * x) * std::cos(250 * y) + random.uniform(-2e-4, 2e-4);
  }));
  return body;
}

/// 131 072 triangles of 1 mm on a ball of 10 cm.
const Body& ball() {
  static const Body body(testing::bumpy_ball(0.1, 7, 0.05, 2));
  return body;
}

/// A hand that strokes the terrain: a curve in 8 s, up to 0.9 m/s; below the mean surface by `depth` [m].
Vec3 stroke(std::int64_t tick, double depth) {
  const double t = 2 * std::numbers::pi * 1e-3 * static_cast<double>(tick) / 8;
  return {0.15 * std::sin(3 * t), 0.15 * std::sin(5 * t + 0.5), -depth};
}

void stroke_terrain(benchmark::State& state, double depth, sim::MeshProxyOptions options, double reach = 0) {
  const Body& body = terrain();
  sim::MeshProxy proxy(options, body.extent());
  proxy.move(stroke(0, -0.01), body.mesh.vertices, body.tree);
  Samples samples;
  std::int64_t tick = 0, touched = 0;
  for (auto _ : state) {
    samples.time(state, [&] {
      if (reach > 0) proxy.expect(reach, body.mesh.vertices, body.mesh.vertices, body.tree);
      const sim::ProxyTouch touch = proxy.move(stroke(tick, depth), body.mesh.vertices, body.tree);
      touched += touch.touched ? 1 : 0;
    });
    ++tick;
  }
  state.counters["touched"] = static_cast<double>(touched) / static_cast<double>(tick);
  samples.report(state);
}

/// Around the ball on a spiral, in and out.
void stroke_ball(benchmark::State& state, sim::MeshProxyOptions options) {
  const Body& body = ball();
  sim::MeshProxy proxy(options, body.extent());
  Samples samples;
  std::int64_t tick = 0, touched = 0;
  const auto path = [](std::int64_t i) {
    const double t = 1e-3 * static_cast<double>(i), radius = 0.1 + 0.006 * std::sin(3 * t), polar = 1.5 + 1.2 * std::sin(0.7 * t);
    return radius * Vec3{std::sin(polar) * std::cos(4 * t), std::sin(polar) * std::sin(4 * t), std::cos(polar)};
  };
  proxy.move_to(1.2 * path(0), body.inside, body.mesh.vertices, body.tree);
  for (auto _ : state) {
    samples.time(state, [&] { touched += proxy.move(path(tick), body.mesh.vertices, body.tree).touched ? 1 : 0; });
    ++tick;
  }
  state.counters["touched"] = static_cast<double>(touched) / static_cast<double>(tick);
  samples.report(state);
}

// 16 000 ticks: twice along the curve.
#define TICKS UseManualTime()->Iterations(16'000)->Unit(benchmark::kMicrosecond)
BENCHMARK_CAPTURE(stroke_terrain, free_flight, -0.02, sim::MeshProxyOptions{})->TICKS;
BENCHMARK_CAPTURE(stroke_terrain, free_over_moving_surface, -0.006, sim::MeshProxyOptions{}, 0.01)->TICKS;
BENCHMARK_CAPTURE(stroke_terrain, frictionless, 0.002, sim::MeshProxyOptions{})->TICKS;
BENCHMARK_CAPTURE(stroke_terrain, friction, 0.002, sim::MeshProxyOptions{.friction = 0.5})->TICKS;
BENCHMARK_CAPTURE(stroke_terrain, deep, 0.01, sim::MeshProxyOptions{.friction = 0.3})->TICKS;
BENCHMARK_CAPTURE(stroke_terrain, sphere_3mm, 0.002, sim::MeshProxyOptions{.friction = 0.3, .radius = 0.003})->TICKS;
BENCHMARK_CAPTURE(stroke_ball, in_and_out, sim::MeshProxyOptions{.friction = 0.3})->TICKS;

void closest_point(benchmark::State& state) {
  const Body& body = ball();
  sim::Random random(3);
  for (auto _ : state) {
    const Vec3 point = testing::random_point(random, 0.15);
    benchmark::DoNotOptimize(body.tree.closest(point, body.mesh.vertices));
  }
}
BENCHMARK(closest_point)->Repetitions(5)->ReportAggregatesOnly();

/// The thesis's membrane: 714 vertices, 1424 triangles.
void refit_membrane(benchmark::State& state) {
  const TriMesh mesh = surface(sim::make_slab(16, 20, 1, 0.01)).mesh;
  sim::AabbTree tree(mesh);
  for (auto _ : state) {
    tree.refit(mesh.vertices);
    benchmark::ClobberMemory();
  }
  state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
}
BENCHMARK(refit_membrane)->Unit(benchmark::kMicrosecond)->Repetitions(5)->ReportAggregatesOnly();

void refit_100k(benchmark::State& state) {
  sim::AabbTree tree(terrain().mesh);
  for (auto _ : state) {
    tree.refit(terrain().mesh.vertices);
    benchmark::ClobberMemory();
  }
}
BENCHMARK(refit_100k)->Unit(benchmark::kMicrosecond)->Repetitions(5)->ReportAggregatesOnly();

void build_100k(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(sim::AabbTree(terrain().mesh));
}
BENCHMARK(build_100k)->Unit(benchmark::kMillisecond);

/// A wave under a hand that strokes the membrane; three rings are cut out every 16 ticks.
void intermediate_model_tick(benchmark::State& state) {
  Body body(surface(sim::make_slab(16, 20, 1, 0.01)).mesh);
  const std::vector<Vec3> rest = body.mesh.vertices;
  sim::IntermediateModel model(body.mesh, body.topology, {.rings = 3, .ticks = 16, .proxy = {.friction = 0.3}});
  model.move_to({0.08, 0.1, 0.03}, body.mesh.vertices, body.tree);
  Samples samples;
  std::int64_t tick = 0;
  for (auto _ : state) {
    const double t = 1e-3 * static_cast<double>(tick);
    if (tick % 16 == 0) {
      for (std::size_t v = 0; v < rest.size(); ++v)
        body.mesh.vertices[v].z = rest[v].z + 0.004 * std::sin(15 * t + 40 * rest[v].x);
      body.tree.refit(body.mesh.vertices);
      model.update(body.mesh.vertices, body.tree);
    }
    const Vec3 probe{0.08 + 0.05 * std::sin(2 * t), 0.1 + 0.06 * std::sin(3 * t), 0.006};
    samples.time(state, [&] { benchmark::DoNotOptimize(model.move(probe)); });
    ++tick;
  }
  samples.report(state);
}
BENCHMARK(intermediate_model_tick)->TICKS;

}  // namespace
}  // namespace tactus
