// SPDX-License-Identifier: Apache-2.0
/// Cost of showing an object and of taking over an update.
#include <tactus/client/stiffness_reduction.h>
#include "tests/bench/shown_object.h"

namespace tactus {
namespace {

void show(benchmark::State& state, Interpolation mode, std::int64_t first) { show_object(state, mode, first); }
BENCHMARK_CAPTURE(show, extrapolated, Interpolation::none, 401)->Repetitions(5)->ReportAggregatesOnly();
BENCHMARK_CAPTURE(show, past, Interpolation::playout, 401)->Repetitions(5)->ReportAggregatesOnly();
BENCHMARK_CAPTURE(show, past_over_a_gap, Interpolation::playout, 201)->Repetitions(5)->ReportAggregatesOnly();

void apply(benchmark::State& state, Interpolation mode) { apply_update(state, mode); }
BENCHMARK_CAPTURE(apply, at_once, Interpolation::none)->Repetitions(5)->ReportAggregatesOnly();
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
