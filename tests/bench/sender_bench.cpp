// SPDX-License-Identifier: Apache-2.0
/// Cost of a whole scene per tick: 100 rigid objects, one of them touched, and a sheet of 714 vertices that has a new shape every tick,
/// without a basis and with one of 48 modes. Neither end may allocate.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/packet/packet.h>
#include <tactus/receiver.h>
#include <tactus/sender.h>
#include "tests/property/allocated.h"
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

constexpr std::size_t kObjects = 100;
constexpr std::size_t kTicks = 256;                 // of the recording, which begins anew
constexpr std::uint32_t kColumns = 20, kRows = 33;  // squares of the sheet

struct Recording {
  SharedScene scene;
  std::vector<RigidSample> samples;  // of all objects, tick by tick
  std::vector<Contact> contacts;     // one per tick
  std::vector<testing::SheetFrame> shapes;
  std::vector<DeformableTruth> truths;  // into `shapes`
};

Recording record(std::size_t modes) {
  const TriMesh mesh = testing::sheet(kColumns, kRows);
  Recording out;
  SceneSpec spec =
      testing::sheet_spec(mesh, DeformableProfile::main, modes == 0 ? ModeBasis{} : testing::wave_basis(mesh, kColumns, modes));
  spec.tick_rate = 1000;
  spec.objects = testing::spec_of(kObjects).objects;
  out.scene = testing::shared(std::move(spec));
  std::vector<testing::Motion> motions;
  for (std::size_t i = 0; i < kObjects; ++i) motions.emplace_back(i);
  testing::DentedSheet sheet(mesh, kColumns);
  for (std::size_t tick = 0; tick < kTicks; ++tick) {
    for (testing::Motion& m : motions) out.samples.push_back(m.step(1e-3));
    out.contacts.push_back(testing::touch(0, out.samples[tick * kObjects].pose, 0.002));
    out.shapes.push_back(sheet.frame(static_cast<std::int64_t>(tick)));
  }
  for (const testing::SheetFrame& shape : out.shapes) out.truths.push_back(shape.truth());
  return out;
}

Truth truth_at(const Recording& r, std::int64_t tick) {
  const std::size_t k = static_cast<std::size_t>(tick) % kTicks;
  return {std::span(r.samples).subspan(k * kObjects, kObjects), {&r.contacts[k], 1}, {&r.truths[k], 1}};
}

Sender make_sender(const Recording& r) {
  SenderOptions options;
  options.policy.key_interval = 0;
  return Sender::create(r.scene, options).value();
}

/// Time and allocations of every call.
class Watch {
 public:
  Watch() { times_.reserve(1 << 20); }

  template <class Call>
  auto look(Call&& call) {
    const std::uint64_t before = testing::allocated_bytes();
    const auto start = Clock::now();
    auto result = call();
    const std::chrono::duration<double, std::micro> time = Clock::now() - start;
    allocated_ += testing::allocated_bytes() - before;
    if (times_.size() < times_.capacity()) times_.push_back(time.count());
    return result;
  }
  void report(benchmark::State& state) {
    if (times_.empty()) return;
    std::ranges::sort(times_);
    const auto at = [&](double fraction) {
      return times_[static_cast<std::size_t>(fraction * static_cast<double>(times_.size() - 1))];
    };
    state.counters["p50_us"] = at(0.5);
    state.counters["p99_us"] = at(0.99);
    state.counters["allocated_bytes"] = static_cast<double>(allocated_);
    if (allocated_ > 0) state.SkipWithError("a call allocates");
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<double> times_;
  std::uint64_t allocated_ = 0;
};

void send_tick(benchmark::State& state) {
  const Recording recording = record(static_cast<std::size_t>(state.range(0)));
  Sender sender = make_sender(recording);
  Watch watch;
  std::int64_t tick = 0;
  std::uint64_t packets = 0, bytes = 0;
  for (auto _ : state) {
    const Truth truth = truth_at(recording, tick);
    const auto sent = watch.look([&] { return sender.encode(tick, truth); });
    if (!sent) {
      state.SkipWithError(sent.error().rule);
      break;
    }
    ++tick;
    packets += sent->size();
    for (const Packet& packet : *sent) bytes += packet.bytes.size();
  }
  state.counters["packets"] = benchmark::Counter(static_cast<double>(packets), benchmark::Counter::kAvgIterations);
  state.counters["bytes"] = benchmark::Counter(static_cast<double>(bytes), benchmark::Counter::kAvgIterations);
  watch.report(state);
}

struct Numbered {
  std::uint64_t number = 0;
  std::vector<std::uint8_t> bytes;
};

/// Pushes all packets; null, or the rule that one breaks.
const char* push_all(Receiver& receiver, std::span<const Numbered> packets) {
  for (const auto& [number, bytes] : packets)
    if (const auto decoded = receiver.push(number, bytes); !decoded) return decoded.error().rule;
  return nullptr;
}

void push_tick(benchmark::State& state) {
  const Recording recording = record(static_cast<std::size_t>(state.range(0)));
  Sender sender = make_sender(recording);
  std::vector<std::vector<Numbered>> ticks(kTicks);
  for (std::size_t k = 0; k < kTicks; ++k) {
    const auto tick = static_cast<std::int64_t>(k);
    const auto sent = sender.encode(tick, truth_at(recording, tick)).value();
    for (const Packet& packet : sent) ticks[k].push_back({packet.number, {packet.bytes.begin(), packet.bytes.end()}});
  }
  auto receiver = Receiver::create(recording.scene).value();
  Watch watch;
  std::size_t next = 0;
  for (auto _ : state) {
    if (next == kTicks) {
      state.PauseTiming();
      receiver = Receiver::create(recording.scene).value();
      next = 0;
      state.ResumeTiming();
    }
    const char* wrong = watch.look([&] { return push_all(receiver, ticks[next++]); });
    if (wrong) {
      state.SkipWithError(wrong);
      break;
    }
  }
  watch.report(state);
}

BENCHMARK(send_tick)->ArgName("modes")->Arg(0)->Arg(48)->Unit(benchmark::kMicrosecond);
BENCHMARK(push_tick)->ArgName("modes")->Arg(0)->Arg(48)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace tactus
