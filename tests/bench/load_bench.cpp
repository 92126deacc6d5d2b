// SPDX-License-Identifier: Apache-2.0
/// Cost of loads: a tick of a sender and a receiver with objects that are pushed, and the same scene without loads.
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>
#include <vector>

#include <tactus/load/load_state.h>
#include <tactus/tactus.h>

namespace tactus {
namespace {

constexpr std::size_t kUsers = 2;

/// in   range(0)  objects; range(1)  1: with loads
void load_ticks(benchmark::State& state) {
  const auto objects = static_cast<std::size_t>(state.range(0));
  SceneBuilder builder;
  for (std::size_t i = 0; i < objects; ++i) builder.rigid("o" + std::to_string(i));
  const bool has_loads = state.range(1) == 1;
  if (has_loads) builder.loads({.users = kUsers});
  const SharedScene scene = builder.build().value();
  auto sender = Sender::create(scene).value();
  auto receiver = Receiver::create(scene).value();
  const std::vector<RigidSample> still(objects);
  std::vector<Vec3> pushes(kUsers), nobody(kUsers);
  std::vector<ObjectLoad> loads(has_loads ? objects : 0, ObjectLoad{{}, {0, 0, 1.3}, nobody});
  if (has_loads) loads[0].pushes = pushes;
  std::int64_t tick = 0;
  std::uint64_t packets = 0, bytes = 0;
  for (auto _ : state) {
    const double force = 1 + std::sin(3e-3 * static_cast<double>(tick));
    pushes[0].x = force;
    if (has_loads) loads[0].external.x = -force;
    const auto sent = sender.encode(tick++, {.objects = still, .loads = loads});
    for (const Packet& packet : sent.value_or(std::span<const Packet>())) {
      benchmark::DoNotOptimize(receiver.push(packet.number, packet.bytes).has_value());
      packets += packet.substream > 0;
      bytes += packet.substream > 0 ? packet.bytes.size() : 0;
    }
  }
  state.counters["packets/s"] = 1000 * static_cast<double>(packets) / static_cast<double>(tick);
  state.counters["bytes/packet"] = packets == 0 ? 0 : static_cast<double>(bytes) / static_cast<double>(packets);
}
BENCHMARK(load_ticks)->ArgNames({"objects", "loads"})->ArgsProduct({{1, 64}, {0, 1}});

}  // namespace
}  // namespace tactus
