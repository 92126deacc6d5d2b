// SPDX-License-Identifier: Apache-2.0
/// Set-up of a basis of vibration modes for the surface of the thesis's membrane, by number of modes.
#include <benchmark/benchmark.h>

#include <tactus/sim/modes/spring_modes.h>
#include <tactus/sim/tets/tet_mesh.h>
#include "tests/unit/fem_fixture.h"

namespace tactus {
namespace {

void spring_modes_of_the_membrane(benchmark::State& state) {
  const TriMesh mesh = surface(sim::make_slab(testing::kSlabX, testing::kSlabY, 1, 0.01)).mesh;
  const auto fixed = testing::slab_corners();
  for (auto _ : state) benchmark::DoNotOptimize(sim::spring_modes(mesh, fixed, static_cast<std::size_t>(state.range(0))));
}

BENCHMARK(spring_modes_of_the_membrane)
    ->Arg(10)
    ->Arg(48)
    ->Arg(200)
    ->Unit(benchmark::kMillisecond)
    ->Repetitions(5)
    ->ReportAggregatesOnly();

}  // namespace
}  // namespace tactus
