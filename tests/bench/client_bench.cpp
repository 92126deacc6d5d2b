// SPDX-License-Identifier: Apache-2.0
/// Cost of showing an object and of taking over an update.
#include <benchmark/benchmark.h>

#include <tactus/client/replica.h>
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
  for (std::int64_t tick = 0; tick <= 400; tick += 200) {
    const RigidSample sample{{{0.001 * static_cast<double>(tick), 0, 0}, {}}, {0.1, 0, 0}, {0, 1, 2}};
    const RigidState state = to_grid(sample, tick, scene.grid).value();
    replica.apply(packet, {&state, 1}, tick);
  }
  return replica;
}

void show(benchmark::State& state, Interpolation mode) {
  const SharedScene scene = testing::scene_of(1);
  const Replica replica = with_update(mode, *scene);
  std::int64_t tick = 0;
  for (auto _ : state) benchmark::DoNotOptimize(replica.pose(0, 401 + tick++ % 90));
}
BENCHMARK_CAPTURE(show, extrapolated, Interpolation::none)->Repetitions(5)->ReportAggregatesOnly();
BENCHMARK_CAPTURE(show, interpolated, Interpolation::linear)->Repetitions(5)->ReportAggregatesOnly();

void apply(benchmark::State& state) {
  const SharedScene scene = testing::scene_of(1);
  Replica replica = with_update(Interpolation::linear, *scene);
  const RigidUpdate named{0, Reason::visual, 0};
  DecodedPacket packet;
  packet.updates = {&named, 1};
  const RigidState next = to_grid({{{0.5, 0, 0}, {}}, {0.1, 0, 0}, {0, 1, 2}}, 1000, scene->grid).value();
  std::int64_t tick = 1000;
  for (auto _ : state) {
    replica.apply(packet, {&next, 1}, tick);
    tick += 200;
  }
}
BENCHMARK(apply)->Repetitions(5)->ReportAggregatesOnly();

}  // namespace
}  // namespace tactus
