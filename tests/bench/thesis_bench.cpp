// SPDX-License-Identifier: Apache-2.0
/// Cost of component thesis: objects that are interpolated at a client, and forces under the deadband.
#include <cmath>

#include <tactus/thesis/force_signal.h>
#include <tactus/thesis/thesis.h>
#include "tests/bench/shown_object.h"

namespace tactus {
namespace {

constexpr std::uint32_t kRate = 1000;

void show(benchmark::State& state, Interpolation mode) { show_object(state, mode, 401, &thesis_component); }
BENCHMARK_CAPTURE(show, interpolated, Interpolation::linear)->Repetitions(5)->ReportAggregatesOnly();
BENCHMARK_CAPTURE(show, on_a_cubic, Interpolation::hermite)->Repetitions(5)->ReportAggregatesOnly();

void apply(benchmark::State& state, Interpolation mode) { apply_update(state, mode, &thesis_component); }
BENCHMARK_CAPTURE(apply, linear, Interpolation::linear)->Repetitions(5)->ReportAggregatesOnly();

/// A force at 1 kHz on a hand that strokes a surface: 0.4 Hz, a tremor of 9 Hz, up to 4 N.
double at(std::int64_t tick, double slow, double fast) {
  const double t = static_cast<double>(tick) / kRate;
  return slow * std::sin(2.5 * t) + fast * std::sin(56.5 * t);
}

void force_ticks(benchmark::State& state) {
  auto sender = ForceSender::create({.predictor = static_cast<ForcePredictor>(state.range(0))}, kRate).value();
  ForceReceiver receiver(kRate);
  std::int64_t tick = 0, samples = 0;
  for (auto _ : state) {
    const auto sample = sender.encode(tick, {at(tick, 2, 0.05), at(tick, 0.5, 0.02), 2 + at(tick, 2, 0.1)});
    if (!sample->empty() && receiver.push(*sample)) ++samples;
    benchmark::DoNotOptimize(receiver.force(tick++));
  }
  state.counters["samples/s"] = static_cast<double>(samples) * kRate / static_cast<double>(tick);
}
BENCHMARK(force_ticks)->ArgName("linear")->Arg(0)->Arg(1);

}  // namespace
}  // namespace tactus
