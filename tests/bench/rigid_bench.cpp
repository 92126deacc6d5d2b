// SPDX-License-Identifier: Apache-2.0
/// Cost of the rigid codec: decision per object and tick, one encoded update, one decoded update, and a crowd at 1 kHz.
#include <benchmark/benchmark.h>

#include <tactus/receiver.h>
#include <tactus/rigid/rigid_predictor.h>
#include <tactus/sender.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

/// Seeded samples of `objects` bodies for `ticks` ticks, tick-major.
std::vector<RigidSample> record(std::size_t objects, std::size_t ticks) {
  std::vector<testing::Motion> motions;
  for (std::size_t i = 0; i < objects; ++i) motions.emplace_back(i);
  std::vector<RigidSample> out;
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    for (testing::Motion& m : motions) out.push_back(m.step(1e-3));
  }
  return out;
}

SenderOptions every_tick() {
  SenderOptions options;
  options.triggers.reduction = Reduction::none;
  options.policy.key_interval = 0;
  return options;
}

/// Prediction and all triggers of one touched object, nothing to send: the sender holds exactly this state.
void decide(benchmark::State& state) {
  SenderOptions options;
  options.triggers.heartbeat = 0;
  const SharedScene scene = testing::scene_of(1);
  const RigidPredictor predictor(*scene);
  auto sender = Sender::create(scene, options).value();
  RigidSample sample;
  sample.velocity = {0.1, 0.02, 0};
  sample.angular_velocity = {0.5, 0.1, 1};
  sample.pose.position = {0.3, 0, 0};
  std::int64_t tick = 0;
  const auto moving = [&](const RigidSample& start, std::int64_t ticks) {
    RigidSample s = start;
    s.pose = to_pose(predictor.pose(to_grid(start, 0, scene->grid).value(), ticks), scene->grid.position);
    return s;
  };
  std::vector<RigidSample> samples;
  for (std::int64_t t = 0; t < 1000; ++t) samples.push_back(moving(sample, t));
  std::uint64_t packets = 0;
  for (auto _ : state) {
    if (tick % 1000 == 0) {
      state.PauseTiming();
      sender = Sender::create(scene, options).value();
      tick = 0;
      (void)sender.encode(tick, {.objects = {&samples[0], 1}});
      state.ResumeTiming();
      ++tick;
    }
    const auto& s = samples[static_cast<std::size_t>(tick)];
    const Contact contact = testing::touch(0, s.pose, 0.002);
    packets += sender.encode(tick++, {.objects = {&s, 1}, .contacts = {&contact, 1}})->size();
  }
  state.counters["packets_per_call"] = benchmark::Counter(static_cast<double>(packets), benchmark::Counter::kAvgIterations);
}
BENCHMARK(decide)->Iterations(900'000)->Repetitions(5)->ReportAggregatesOnly();

/// One update per tick, decision included.
void encode_update(benchmark::State& state) {
  auto sender = Sender::create(testing::scene_of(1), every_tick()).value();
  const auto samples = record(1, 10000);
  std::int64_t tick = 0;
  std::uint64_t bytes = 0;
  for (auto _ : state) {
    const RigidSample& s = samples[static_cast<std::size_t>(tick) % samples.size()];
    bytes += testing::only(sender.encode(tick++, {.objects = {&s, 1}})).bytes.size();
  }
  state.counters["bytes"] = benchmark::Counter(static_cast<double>(bytes), benchmark::Counter::kAvgIterations);
}
BENCHMARK(encode_update)->Repetitions(5)->ReportAggregatesOnly();

/// One touched update per tick: the grid level is searched with the haptic rule.
void encode_touched_update(benchmark::State& state, bool is_smoothed) {
  SenderOptions options = every_tick();
  options.triggers.reduction = Reduction::dead_reckoning;
  options.triggers.weber_fraction = 0.001;
  SceneSpec spec = testing::spec_of(1);
  spec.is_smoothed = is_smoothed;
  auto sender = Sender::create(testing::shared(spec), options).value();
  const auto samples = record(1, 10000);
  std::int64_t tick = 0;
  std::uint64_t packets = 0;
  for (auto _ : state) {
    const RigidSample& s = samples[static_cast<std::size_t>(tick) % samples.size()];
    const Contact contact = testing::touch(0, s.pose, 0.002);
    packets += sender.encode(tick++, {.objects = {&s, 1}, .contacts = {&contact, 1}})->size();
  }
  state.counters["packets_per_call"] = benchmark::Counter(static_cast<double>(packets), benchmark::Counter::kAvgIterations);
}
BENCHMARK_CAPTURE(encode_touched_update, thesis, false)->Repetitions(5)->ReportAggregatesOnly();
BENCHMARK_CAPTURE(encode_touched_update, main, true)->Repetitions(5)->ReportAggregatesOnly();

/// A key packet per tick of an object that falls: every predictor is held against the whole past.
void encode_choosing_update(benchmark::State& state, const MotionPhysics& physics) {
  SenderOptions options;
  options.triggers.haptic = HapticRule::off;
  auto sender = Sender::create(SceneBuilder().rigid("o").motion(physics).build().value(), options).value();
  std::int64_t tick = 0;
  std::uint64_t packets = 0;
  for (auto _ : state) {
    const double t = 1e-3 * static_cast<double>(tick % 2000);
    RigidSample s{{{1 + 0.01 * t, 0, -0.05 * t * t}, {}}, {0.01, 0, -0.1 * t}, {0.1, 0, 0}};
    sender.request_key();
    packets += sender.encode(tick++, {.objects = {&s, 1}})->size();
  }
  state.counters["packets_per_call"] = benchmark::Counter(static_cast<double>(packets), benchmark::Counter::kAvgIterations);
}
BENCHMARK_CAPTURE(encode_choosing_update, linear_alone, MotionPhysics{})->Repetitions(5)->ReportAggregatesOnly();
BENCHMARK_CAPTURE(encode_choosing_update, of_three, MotionPhysics{{0, 0, -0.1}, 0.25})->Repetitions(5)->ReportAggregatesOnly();

void decode_update(benchmark::State& state) {
  const SharedScene scene = testing::scene_of(1);
  auto sender = Sender::create(scene, every_tick()).value();
  const auto samples = record(1, 10000);
  std::vector<std::vector<std::uint8_t>> packets;
  for (std::size_t tick = 0; tick < samples.size(); ++tick) {
    const Packet packet = testing::only(sender.encode(static_cast<std::int64_t>(tick), {.objects = {&samples[tick], 1}}));
    packets.emplace_back(packet.bytes.begin(), packet.bytes.end());
  }
  auto receiver = Receiver::create(scene).value();
  std::size_t next = 0;
  for (auto _ : state) {
    if (next == packets.size()) {
      state.PauseTiming();
      receiver = Receiver::create(scene).value();
      next = 0;
      state.ResumeTiming();
    }
    const std::uint64_t number = next + 1;
    auto decoded = receiver.push(number, packets[next++]);
    if (!decoded) state.SkipWithError(decoded.error().rule);
    benchmark::DoNotOptimize(decoded);
  }
}
BENCHMARK(decode_update)->Repetitions(5)->ReportAggregatesOnly();

/// Objects at 1 kHz on one core: real_time_factor above 1 keeps up.
void crowd(benchmark::State& state) {
  const auto objects = static_cast<std::size_t>(state.range(0));
  constexpr std::size_t kTicks = 200;
  const auto samples = record(objects, kTicks);
  auto sender = Sender::create(testing::scene_of(objects)).value();
  std::int64_t tick = 0;
  std::uint64_t updates = 0;
  for (auto _ : state) {
    const auto at = static_cast<std::size_t>(tick) % kTicks * objects;
    const auto packets = sender.encode(tick++, {.objects = std::span(samples).subspan(at, objects)});
    for (const Packet& packet : *packets) updates += packet.updates;
  }
  state.counters["updates_per_tick"] = benchmark::Counter(static_cast<double>(updates), benchmark::Counter::kAvgIterations);
  state.counters["real_time_factor"] =
      benchmark::Counter(1e-3 * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(crowd)->Arg(1)->Arg(10)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond)->Repetitions(5)->ReportAggregatesOnly();

}  // namespace
}  // namespace tactus
