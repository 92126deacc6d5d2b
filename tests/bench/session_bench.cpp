// SPDX-License-Identifier: Apache-2.0
/// Cost of sessions: a server that sends 10 moving objects at 1 kHz to so many live clients, each 10 ms from it, and what a
/// datagram costs a client, a true one and one of a stranger. Time is virtual: only the calls that are named are measured.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <deque>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <tactus/scene/scene_builder.h>
#include <tactus/session/device_signal.h>
#include <tactus/session/session_client.h>
#include <tactus/session/session_server.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kObjects = 10;
constexpr std::uint64_t kTick = 1000, kDelay = 10'000;  // [us]
constexpr int kWarmUp = 2000;                           // ticks

class World {
 public:
  /// in   reduction  none: every client gets a packet in every tick
  explicit World(std::size_t clients, Reduction reduction = Reduction::dead_reckoning) {
    SceneBuilder builder(1000);
    for (std::size_t i = 0; i < kObjects; ++i) {
      builder.rigid("body " + std::to_string(i));
      motions_.emplace_back(i + 1);
    }
    samples_.resize(kObjects);
    SessionServerOptions options;
    options.clients = static_cast<std::uint16_t>(clients);
    options.sender.triggers.reduction = reduction;
    server =
        std::make_unique<SessionServer>(SessionServer::create(builder.baselines(64).build().value(), options, 1, now_).value());
    for (std::size_t i = 0; i < clients; ++i) {
      clients_.push_back({std::make_unique<SessionClient>(SessionClient::create({}).value()), {}, {}});
      clients_.back().end->open(now_, i + 1);
    }
    for (int i = 0; i < kWarmUp; ++i) step();
    server_time = client_time = {};
    up = down = bytes = 0;
  }
  bool all_live() const {
    for (std::uint16_t i = 0; i < clients_.size(); ++i)
      if (server->status(i).state != SessionState::live) return false;
    return true;
  }
  /// A tick of the server, its datagrams, and what else arrives.
  void step() {
    for (std::size_t i = 0; i < kObjects; ++i) samples_[i] = motions_[i].step(1e-3);
    const auto start = Clock::now();
    if (!server->submit(now_, tick_++, {.objects = samples_, .contacts = {}, .deformables = {}})) std::abort();
    server_time += Clock::now() - start;
    drain();
    for (std::size_t i = 0; i < clients_.size(); ++i) {
      for (; !clients_[i].down.empty() && clients_[i].down.front().due <= now_; clients_[i].down.pop_front()) {
        const auto heard = Clock::now();
        if (!clients_[i].end->handle_datagram(now_, clients_[i].down.front().bytes)) std::abort();
        client_time += Clock::now() - heard;
        ++down;
      }
      while (const auto datagram = clients_[i].end->poll_datagram(now_))
        clients_[i].up.push_back({now_ + kDelay, Bytes(datagram->begin(), datagram->end())});
      for (; !clients_[i].up.empty() && clients_[i].up.front().due <= now_; clients_[i].up.pop_front()) {
        const auto heard = Clock::now();
        if (!server->handle_datagram(now_, i + 1, clients_[i].up.front().bytes)) std::abort();
        server_time += Clock::now() - heard;
        ++up;
        drain();
      }
    }
    now_ += kTick;
  }

  std::unique_ptr<SessionServer> server;
  Clock::duration server_time{}, client_time{};
  std::uint64_t up = 0, down = 0, bytes = 0;  // datagrams that arrived; bytes down

 private:
  void drain() {
    for (;;) {
      const auto start = Clock::now();
      const auto datagram = server->poll_datagram(now_);
      server_time += Clock::now() - start;
      if (!datagram) return;
      bytes += datagram->bytes.size();
      clients_[datagram->peer - 1].down.push_back({now_ + kDelay, Bytes(datagram->bytes.begin(), datagram->bytes.end())});
    }
  }
  struct InFlight {
    std::uint64_t due = 0;
    Bytes bytes;
  };
  struct Client {
    std::unique_ptr<SessionClient> end;
    std::deque<InFlight> up, down;
  };
  std::uint64_t now_ = 1'000'000;
  std::int64_t tick_ = 0;
  std::vector<testing::Motion> motions_;
  std::vector<RigidSample> samples_;
  std::vector<Client> clients_;
};

Reduction reduction_of(std::int64_t every_tick) { return every_tick ? Reduction::none : Reduction::dead_reckoning; }

double seconds(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

/// A tick: submit(), every datagram out, every acknowledgement in.
void serve_tick(benchmark::State& state) {
  World world(static_cast<std::size_t>(state.range(0)), reduction_of(state.range(1)));
  if (!world.all_live()) return state.SkipWithError("a client is not live");
  double last = 0;
  for (auto _ : state) {
    world.step();
    const double now = seconds(world.server_time);
    state.SetIterationTime(now - last);
    last = now;
  }
  const auto per = [&state](double value) { return benchmark::Counter(value, benchmark::Counter::kAvgIterations); };
  const auto clients = static_cast<double>(state.range(0));
  state.counters["us_per_client"] = per(1e6 * last / clients);
  state.counters["down_per_client"] = per(static_cast<double>(world.down) / clients);
  state.counters["up_per_client"] = per(static_cast<double>(world.up) / clients);
  state.counters["bytes_per_client"] = per(static_cast<double>(world.bytes) / clients);
  if (!world.all_live()) state.SkipWithError("a client was lost");
}

/// A datagram from the server at a client: opened, decoded, noted for the acknowledgement.
void hear_datagram(benchmark::State& state) {
  World world(1, reduction_of(state.range(0)));
  for (auto _ : state) {
    const std::uint64_t before = world.down;
    world.client_time = {};
    while (world.down == before) world.step();
    state.SetIterationTime(seconds(world.client_time) / static_cast<double>(world.down - before));
  }
}

/// What a stranger sends to a server of 64 clients: nonsense of so many bytes from an address of no client.
void refuse_datagram(benchmark::State& state) {
  World world(64);
  Bytes bytes(static_cast<std::size_t>(state.range(0)));
  std::mt19937_64 random(1);
  for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
  for (auto _ : state) {
    const auto refused = world.server->handle_datagram(10'000'000, static_cast<std::uint64_t>(state.range(1)), bytes);
    if (refused) return state.SkipWithError("it was taken");
  }
  state.SetBytesProcessed(state.iterations() * state.range(0));
}

/// A sample of a hand in contact: coded, and into a datagram if its receiver would be wrong.
void send_device(benchmark::State& state) {
  const SharedScene scene = device_scene(*testing::scene_of(1)).value();
  Sender sender = Sender::create(scene, device_sender_options({})).value();
  DeviceTruth truth(scene->tick_rate, false);
  std::int64_t tick = 0;
  std::uint64_t packets = 0;
  for (auto _ : state) {
    const double t = 1e-3 * static_cast<double>(tick);
    const Vec3 position{0.05 * std::sin(3 * t), 0.05 * std::cos(2 * t), 1e-4 * std::sin(57 * t)};
    const auto sent =
        sender.encode(tick, truth.of(tick, {.position = position}, DeviceContact{position + Vec3{0, 0, 2e-3}, 500}));
    if (!sent) return state.SkipWithError(sent.error().rule);
    packets += sent->size();
    ++tick;
    for (const Packet& packet : *sent) sender.acknowledge(packet.substream, packet.number);
  }
  state.counters["packets"] = benchmark::Counter(static_cast<double>(packets), benchmark::Counter::kAvgIterations);
}

BENCHMARK(send_device);
BENCHMARK(serve_tick)
    ->ArgNames({"clients", "every_tick"})
    ->ArgsProduct({{1, 8, 64}, {0, 1}})
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(hear_datagram)->ArgName("every_tick")->Arg(0)->Arg(1)->UseManualTime()->Unit(benchmark::kMicrosecond);
BENCHMARK(refuse_datagram)->ArgNames({"bytes", "peer"})->Args({40, 1000})->Args({1200, 1000})->Args({1200, 64});

}  // namespace
}  // namespace tactus
