// SPDX-License-Identifier: Apache-2.0
/// What the C interface adds: the calls that an engine makes in each tick, in C++ and in C, on the same scenes, packets and truth.
/// bindings_bench.py times the same calls in Python, bindings_bench.mjs in JavaScript.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/bindings_ends.h"
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using bench::C;
using bench::Cpp;

constexpr std::size_t kObjects = 10;
constexpr std::uint32_t kColumns = 20, kRows = 33;  // of the sheet: 714 vertices
constexpr std::size_t kVertices = (kColumns + 1) * (kRows + 1);
constexpr std::size_t kBatch = 256;  // calls between two looks at the clock

/// A scene and packets of its one substream, numbered from 1.
struct Stream {
  SharedScene scene;
  std::vector<std::vector<std::uint8_t>> packets;
};

/// Moving objects: most packets name one of them.
Stream rigid_stream() {
  Stream out{testing::scene_of(kObjects), {}};
  Sender sender = Sender::create(out.scene).value();
  std::vector<testing::Motion> motions;
  for (std::size_t i = 0; i < kObjects; ++i) motions.emplace_back(i);
  std::vector<RigidSample> samples(kObjects);
  for (std::int64_t tick = 0; out.packets.size() < kBatch; ++tick) {
    for (std::size_t i = 0; i < kObjects; ++i) samples[i] = motions[i].step(1e-3);
    for (const Packet& packet : testing::all(sender.encode(tick, {.objects = samples})))
      out.packets.emplace_back(packet.bytes.begin(), packet.bytes.end());
  }
  return out;
}

/// A sheet that is dented, 60 times a second.
Stream mesh_stream() {
  const TriMesh mesh = testing::sheet(kColumns, kRows);
  Stream out{testing::shared(testing::sheet_spec(mesh)), {}};
  testing::SheetEnds ends(out.scene);
  testing::DentedSheet sheet(mesh, kColumns);
  for (std::int64_t tick = 0; out.packets.size() < kBatch; ++tick)
    for (const Packet& packet : testing::all(ends.encode(tick, sheet.frame(tick))))
      out.packets.emplace_back(packet.bytes.begin(), packet.bytes.end());
  return out;
}

template <class Language>
void push(benchmark::State& state, const Stream& stream) {
  while (state.KeepRunningBatch(kBatch)) {
    state.PauseTiming();
    typename Language::Decoder decoder(stream.scene);
    state.ResumeTiming();
    for (std::size_t i = 0; i < kBatch; ++i) decoder.push(i + 1, stream.packets[i]);
  }
}
template <class Language>
void push_rigid(benchmark::State& state) {
  push<Language>(state, rigid_stream());
}
template <class Language>
void push_mesh(benchmark::State& state) {
  push<Language>(state, mesh_stream());
}

template <class Language>
void show_poses(benchmark::State& state) {
  const Stream stream = rigid_stream();
  typename Language::Decoder decoder(stream.scene);
  for (std::size_t i = 0; i < stream.packets.size(); ++i) decoder.push(i + 1, stream.packets[i]);
  std::vector<typename Language::Shown> shown(kObjects);
  std::int64_t tick = 0;
  for (auto _ : state) {
    decoder.poses(2000 + tick++ % 4000, shown);
    benchmark::DoNotOptimize(shown.data());
  }
}

template <class Language>
void show_mesh(benchmark::State& state) {
  const Stream stream = mesh_stream();
  typename Language::Decoder decoder(stream.scene);
  for (std::size_t i = 0; i < stream.packets.size(); ++i) decoder.push(i + 1, stream.packets[i]);
  std::vector<float> shown(3 * kVertices);
  std::int64_t tick = 0;
  for (auto _ : state) {
    decoder.displacements(2000 + tick++ % 4000, shown);
    benchmark::DoNotOptimize(shown.data());
  }
}

/// Objects that sway by 2 mm, which is within their bounds: nothing is due, unless everything always is.
std::vector<RigidSample> swaying(std::int64_t tick) {
  std::vector<RigidSample> out(kObjects);
  for (std::size_t i = 0; i < kObjects; ++i) {
    const double rate = 1 + static_cast<double>(i), phase = 1e-3 * rate * static_cast<double>(tick);
    out[i].pose.position = {0.002 * std::sin(phase), 0, 0};
    out[i].velocity = {0.002 * rate * std::cos(phase), 0, 0};
  }
  return out;
}

template <class Language>
void encode(benchmark::State& state, Reduction reduction) {
  std::vector<std::vector<typename Language::Sample>> truth;
  for (std::size_t i = 0; i < kBatch; ++i) truth.push_back(Language::samples(swaying(static_cast<std::int64_t>(i))));
  std::vector<std::uint8_t> room(4096);
  std::size_t packets = 0;
  while (state.KeepRunningBatch(kBatch - 1)) {
    state.PauseTiming();
    typename Language::Encoder encoder(testing::scene_of(kObjects), reduction);
    encoder.encode(0, truth[0], room);
    state.ResumeTiming();
    for (std::size_t i = 1; i < kBatch; ++i) packets += encoder.encode(static_cast<std::int64_t>(i), truth[i], room);
  }
  state.counters["packets"] = benchmark::Counter(static_cast<double>(packets), benchmark::Counter::kAvgIterations);
}
template <class Language>
void encode_nothing(benchmark::State& state) {
  encode<Language>(state, Reduction::dead_reckoning);
}
template <class Language>
void encode_packet(benchmark::State& state) {
  encode<Language>(state, Reduction::none);
}

/// A tick of one end of a session, while the other answers at once.
template <class Language, bool is_server>
void session_tick(benchmark::State& state) {
  using Clock = std::chrono::steady_clock;
  SceneBuilder builder(1000);
  for (std::size_t i = 0; i < kObjects; ++i) builder.rigid("body " + std::to_string(i));
  typename Language::Session session(builder.baselines(64).build().value());
  std::vector<testing::Motion> motions;
  for (std::size_t i = 0; i < kObjects; ++i) motions.emplace_back(i);
  std::vector<std::vector<typename Language::Sample>> truth(1 << 14);
  for (auto& samples : truth) {
    std::vector<RigidSample> now(kObjects);
    for (std::size_t i = 0; i < kObjects; ++i) now[i] = motions[i].step(1e-3);
    samples = Language::samples(now);
  }
  std::vector<typename Language::Shown> shown(kObjects);
  std::int64_t tick = 0;
  std::size_t live = 0;
  const auto step = [&] {
    const auto now = static_cast<std::uint64_t>(1000 * tick);
    const auto begin = Clock::now();
    session.serve(now, tick, truth[static_cast<std::size_t>(tick) % truth.size()]);
    const auto between = Clock::now();
    live += session.join(now, shown);
    const auto end = Clock::now();
    ++tick;
    return std::chrono::duration<double>(is_server ? between - begin : end - between).count();
  };
  while (live < 500) step();
  std::vector<double> times;
  for (auto _ : state) {
    times.push_back(step());
    state.SetIterationTime(times.back());
  }
  std::ranges::nth_element(times, times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2));
  state.counters["p50_us"] = 1e6 * times[times.size() / 2];
}
template <class Language>
void serve_tick(benchmark::State& state) {
  session_tick<Language, true>(state);
}
template <class Language>
void join_tick(benchmark::State& state) {
  session_tick<Language, false>(state);
}

#define IN_BOTH(call, ...)                              \
  BENCHMARK(call<Cpp>)->Name(#call "/c++") __VA_ARGS__; \
  BENCHMARK(call<C>)->Name(#call "/c") __VA_ARGS__

IN_BOTH(push_rigid);
IN_BOTH(push_mesh);
IN_BOTH(show_poses);
IN_BOTH(show_mesh);
IN_BOTH(encode_nothing);
IN_BOTH(encode_packet);
IN_BOTH(serve_tick, ->UseManualTime());
IN_BOTH(join_tick, ->UseManualTime());

}  // namespace
}  // namespace tactus
