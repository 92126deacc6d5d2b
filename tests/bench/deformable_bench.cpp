// SPDX-License-Identifier: Apache-2.0
/// Cost of deformable objects per frame, and of making both ends ready: both profiles, with and without a basis, 10^2 to 10^6
/// vertices. A dent walks over a sheet.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>

#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

constexpr std::size_t kFrames = 64;  // of the recording, which is walked to and fro

enum class Kind { thesis, main, basis };

struct Recording {
  SharedScene scene;
  std::vector<testing::SheetFrame> frames;
};

Recording record(std::uint32_t squares, Kind kind) {
  const TriMesh mesh = testing::sheet(squares, squares);
  Recording out;
  out.scene =
      testing::shared(testing::sheet_spec(mesh, kind == Kind::thesis ? DeformableProfile::thesis : DeformableProfile::main,
                                          kind == Kind::basis ? testing::wave_basis(mesh, squares, 48) : ModeBasis{}),
                      testing::kWithThesis);
  testing::DentedSheet sheet(mesh, squares);
  const std::size_t frames = squares > 300 ? 8 : kFrames;
  for (std::size_t k = 0; k < frames; ++k) out.frames.push_back(sheet.frame(static_cast<std::int64_t>(k)));
  return out;
}

const testing::SheetFrame& frame_at(const Recording& r, std::int64_t tick) {
  const auto period = static_cast<std::int64_t>(2 * r.frames.size() - 2);
  const std::int64_t k = tick % period;
  return r.frames[static_cast<std::size_t>(std::min(k, period - k))];
}

std::size_t vertices_of(const Recording& r) { return r.scene->deformables[0].rest.size(); }

Sender make_sender(const Recording& r) {
  SenderOptions options;
  options.policy.key_interval = 0;
  return Sender::create(r.scene, options).value();
}

using Clock = std::chrono::steady_clock;

double microseconds(Clock::duration d) { return std::chrono::duration<double, std::micro>(d).count(); }

void report(benchmark::State& state, std::vector<double>& times) {
  std::sort(times.begin(), times.end());
  const auto at = [&](double fraction) {
    return times[static_cast<std::size_t>(fraction * static_cast<double>(times.size() - 1))];
  };
  state.counters["p50_us"] = at(0.5);
  state.counters["p99_us"] = at(0.99);
}

void encode_frame(benchmark::State& state, Kind kind) {
  const auto squares = static_cast<std::uint32_t>(state.range(0));
  const Recording recording = record(squares, kind);
  const std::size_t before = mallinfo2().uordblks + mallinfo2().hblkhd;
  Sender sender = make_sender(recording);
  const std::size_t memory = mallinfo2().uordblks + mallinfo2().hblkhd - before;
  std::vector<double> times;
  times.reserve(1 << 20);
  std::uint64_t bytes = 0;
  std::int64_t tick = 0;
  for (auto _ : state) {
    const testing::SheetFrame& frame = frame_at(recording, tick);
    const DeformableTruth truth = frame.truth();
    const auto start = Clock::now();
    const auto packets = sender.encode(tick++, {.deformables = {&truth, 1}});
    const auto end = Clock::now();
    if (times.size() < times.capacity()) times.push_back(microseconds(end - start));
    for (const Packet& packet : *packets) bytes += packet.bytes.size();
  }
  report(state, times);
  state.counters["bytes_per_vertex"] = static_cast<double>(memory) / static_cast<double>(vertices_of(recording));
  state.counters["vertices"] = static_cast<double>(vertices_of(recording));
  state.counters["bytes"] = benchmark::Counter(static_cast<double>(bytes), benchmark::Counter::kAvgIterations);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(vertices_of(recording)));
}

void decode_frame(benchmark::State& state, Kind kind) {
  const auto squares = static_cast<std::uint32_t>(state.range(0));
  const Recording recording = record(squares, kind);
  Sender sender = make_sender(recording);
  std::vector<std::vector<std::uint8_t>> packets;
  for (std::size_t k = 0; k < recording.frames.size(); ++k) {
    const DeformableTruth truth = recording.frames[k].truth();
    const Packet packet = testing::only(sender.encode(static_cast<std::int64_t>(k), {.deformables = {&truth, 1}}));
    if (!packet.bytes.empty()) packets.emplace_back(packet.bytes.begin(), packet.bytes.end());
  }
  const std::size_t before = mallinfo2().uordblks + mallinfo2().hblkhd;
  auto receiver = Receiver::create(recording.scene).value();
  const std::size_t memory = mallinfo2().uordblks + mallinfo2().hblkhd - before;
  std::vector<double> times;
  times.reserve(1 << 20);
  std::size_t next = 0;
  for (auto _ : state) {
    if (next == packets.size()) {
      state.PauseTiming();
      receiver = Receiver::create(recording.scene).value();
      next = 0;
      state.ResumeTiming();
    }
    const auto start = Clock::now();
    const std::uint64_t number = next + 1;
    const auto decoded = receiver.push(number, packets[next++]);
    const auto end = Clock::now();
    if (times.size() < times.capacity()) times.push_back(microseconds(end - start));
    if (!decoded) state.SkipWithError(decoded.error().rule);
  }
  report(state, times);
  state.counters["bytes_per_vertex"] = static_cast<double>(memory) / static_cast<double>(vertices_of(recording));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(vertices_of(recording)));
}

SharedScene still_sheet(std::uint32_t squares) { return testing::shared(testing::sheet_spec(testing::sheet(squares, squares))); }

void create_sender(benchmark::State& state) {
  const SharedScene scene = still_sheet(static_cast<std::uint32_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(Sender::create(scene));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(scene->deformables[0].rest.size()));
}

void create_receiver(benchmark::State& state) {
  const SharedScene scene = still_sheet(static_cast<std::uint32_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(Receiver::create(scene));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(scene->deformables[0].rest.size()));
}

/// The scene's part of it: the basis that both ends compute.
void compute_basis(benchmark::State& state) {
  const auto squares = static_cast<std::uint32_t>(state.range(0));
  SceneSpec spec = testing::sheet_spec(testing::sheet(squares, squares));
  spec.deformables[0].spring_basis = {static_cast<std::uint8_t>(state.range(1)), {0, squares}};
  for (auto _ : state) benchmark::DoNotOptimize(Scene::create(spec));
  state.counters["vertices"] = static_cast<double>(spec.deformables[0].rest.size());
}

/// The same of clusters: stripes across the sheet, blended so often.
void blend_clusters(benchmark::State& state) {
  const auto squares = static_cast<std::uint32_t>(state.range(0));
  SceneSpec spec = testing::sheet_spec(testing::sheet(squares, squares));
  ClusterBasis& basis = spec.deformables[0].cluster_basis;
  basis = {40, static_cast<std::uint8_t>(state.range(1)), {}};
  const std::size_t vertices = spec.deformables[0].rest.size();
  for (std::size_t v = 0; v < vertices; ++v) basis.clusters.push_back(static_cast<std::uint8_t>(40 * v / vertices));
  for (auto _ : state) benchmark::DoNotOptimize(Scene::create(spec));
  state.counters["vertices"] = static_cast<double>(vertices);
}

BENCHMARK(blend_clusters)->Args({70, 8})->Args({223, 32})->Args({999, 12})->Unit(benchmark::kMillisecond);
BENCHMARK(compute_basis)->Args({26, 48})->Args({70, 48})->Args({223, 48})->Args({26, 64})->Unit(benchmark::kMillisecond);
BENCHMARK(create_sender)->Arg(31)->Arg(99)->Arg(315)->Arg(999)->Unit(benchmark::kMillisecond);
BENCHMARK(create_receiver)->Arg(31)->Arg(99)->Arg(315)->Arg(999)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(encode_frame, thesis, Kind::thesis)->Arg(26)->Arg(99)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(encode_frame, main, Kind::main)->Arg(9)->Arg(26)->Arg(99)->Arg(315)->Arg(1023)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(encode_frame, basis, Kind::basis)->Arg(26)->Arg(99)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(decode_frame, thesis, Kind::thesis)->Arg(26)->Arg(99)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(decode_frame, main, Kind::main)->Arg(9)->Arg(26)->Arg(99)->Arg(315)->Arg(1023)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(decode_frame, basis, Kind::basis)->Arg(26)->Arg(99)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace tactus
