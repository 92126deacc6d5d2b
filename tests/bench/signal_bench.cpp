// SPDX-License-Identifier: Apache-2.0
/// Cost of the samples of a device, per tick.
#include <benchmark/benchmark.h>

#include <cmath>
#include <optional>
#include <span>

#include <tactus/session/device_signal.h>
#include <tactus/tactus.h>

namespace tactus {
namespace {

constexpr std::uint32_t kRate = 1000;

/// A hand at 1 kHz that strokes a surface: 0.4 Hz, with a tremor of 9 Hz.
double at(std::int64_t tick, double slow, double fast) {
  const double t = static_cast<double>(tick) / kRate;
  return slow * std::sin(2.5 * t) + fast * std::sin(56.5 * t);
}

/// in   range  1: in contact with a surface of 500 N/m
void device_ticks(benchmark::State& state) {
  const SharedScene scene = device_scene({}).value();
  auto sender = Sender::create(scene, device_sender_options({})).value();
  auto receiver = Receiver::create(scene).value();
  DeviceTruth truth(kRate, false);
  std::int64_t tick = 0, packets = 0;
  for (auto _ : state) {
    DeviceSample sample;
    sample.position = {at(tick, 0.05, 1e-4), at(tick, 0.02, 1e-4), at(tick, 0.03, 2e-4)};
    std::optional<DeviceContact> contact;
    if (state.range(0) == 1) contact = DeviceContact{{sample.position.x, sample.position.y, 0.04}, 500};
    const auto sent = sender.encode(tick, truth.of(tick, sample, contact));
    for (const Packet& packet : sent.value_or(std::span<const Packet>())) {
      benchmark::DoNotOptimize(receiver.push(packet.number, packet.bytes).has_value());
      sender.acknowledge(packet.substream, packet.number);
      ++packets;
    }
    benchmark::DoNotOptimize(device_at(receiver, tick++, 0));
  }
  state.counters["packets/s"] = static_cast<double>(packets) * kRate / static_cast<double>(tick);
}
BENCHMARK(device_ticks)->ArgName("contact")->Arg(0)->Arg(1);

}  // namespace
}  // namespace tactus
