// SPDX-License-Identifier: Apache-2.0
/// Cost of showing an object and of taking over an update.
#include <benchmark/benchmark.h>

#include <tactus/client/replica.h>
#include <tactus/client/stiffness_reduction.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

Replica with_update(Interpolation mode, const Scene& scene) {
  ReplicaOptions options;
  options.interpolation = mode;
  Replica replica(scene, options, {});
  const RigidUpdate named{0, Reason::visual, 0};
  DecodedPacket packet;
  packet.updates = {&named, 1};
  packet.number = 1;
  for (std::int64_t tick = 0; tick <= 400; tick += 200) {
    packet.tick = tick;
    const RigidSample sample{{{0.001 * static_cast<double>(tick), 0, 0}, {}}, {0.1, 0, 0}, {0, 1, 2}};
    const RigidState state = to_grid(sample, tick, scene.grid).value();
    replica.apply(packet, {&state, 1}, tick);
    packet.number += 2;  // every other packet is missing
  }
  return replica;
}

void show(benchmark::State& state, Interpolation mode, std::int64_t first) {
  const SharedScene scene = testing::scene_of(1);
  const Replica replica = with_update(mode, *scene);
  std::int64_t tick = 0;
  for (auto _ : state) benchmark::DoNotOptimize(replica.pose(0, first + tick++ % 90));
}
BENCHMARK_CAPTURE(show, extrapolated, Interpolation::none, 401)->Repetitions(5)->ReportAggregatesOnly();
BENCHMARK_CAPTURE(show, interpolated, Interpolation::linear, 401)->Repetitions(5)->ReportAggregatesOnly();
BENCHMARK_CAPTURE(show, on_a_cubic, Interpolation::hermite, 401)->Repetitions(5)->ReportAggregatesOnly();
BENCHMARK_CAPTURE(show, past, Interpolation::playout, 401)->Repetitions(5)->ReportAggregatesOnly();
BENCHMARK_CAPTURE(show, past_over_a_gap, Interpolation::playout, 201)->Repetitions(5)->ReportAggregatesOnly();

void apply(benchmark::State& state, Interpolation mode) {
  const SharedScene scene = testing::scene_of(1);
  Replica replica = with_update(mode, *scene);
  const RigidUpdate named{0, Reason::visual, 0};
  DecodedPacket packet;
  packet.updates = {&named, 1};
  packet.number = 10;
  RigidState next = to_grid({{{0.5, 0, 0}, {}}, {0.1, 0, 0}, {0, 1, 2}}, 1000, scene->grid).value();
  std::int64_t tick = 1000;
  for (auto _ : state) {
    packet.tick = next.tick = tick;
    ++packet.number;
    replica.apply(packet, {&next, 1}, tick);
    tick += 200;
  }
}
BENCHMARK_CAPTURE(apply, linear, Interpolation::linear)->Repetitions(5)->ReportAggregatesOnly();
BENCHMARK_CAPTURE(apply, playout, Interpolation::playout)->Repetitions(5)->ReportAggregatesOnly();

/// A tick of a client that makes up for delay while it presses.
void reduce(benchmark::State& state) {
  auto reduction = StiffnessReduction::create({}).value();
  double z = 0;
  for (auto _ : state) {
    reduction.move({0, 0, z -= 1e-6});
    benchmark::DoNotOptimize(reduction.reduced(StiffnessReduction::DeformableTouch{{0, 0, -0.01}, {0, 0, 1}, 340, 100}, 80));
  }
}
BENCHMARK(reduce)->Repetitions(5)->ReportAggregatesOnly();

}  // namespace
}  // namespace tactus
