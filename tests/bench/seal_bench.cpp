// SPDX-License-Identifier: Apache-2.0
/// Cost of the seal: sealing and opening a datagram, a whole handshake with both ends in this thread, what the server's end of it takes
/// in each of its two steps, and a stranger's datagram.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include <tactus/seal/seal_client.h>
#include <tactus/seal/seal_server.h>

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kPause = 1000;  // [us] between datagrams, within the rates that a server permits
const net::Address kClient = net::Address::parse("192.0.2.1:4000").value();

seal::Key key() { return seal::Key::parse("tactus key 1\nname lab\nsecret " + std::string(64, '7') + "\n", "").value(); }

struct Pair {
  std::uint64_t now = 1;
  seal::Server server = seal::Server::create(key(), now).value();
  seal::Client client = seal::Client::create(key(), now).value();
  std::vector<double> steps;  // [us]

  void up() {
    while (const auto message = client.poll_datagram()) static_cast<void>(server.open(now, kClient, *message));
    while (server.has_work()) {
      const auto start = Clock::now();
      server.work(now);
      steps.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
    }
  }
  void shake() {
    for (int i = 0; i < 10 && !client.is_open(); ++i) {
      up();
      while (const auto message = server.poll_datagram()) static_cast<void>(client.open(now, message->bytes));
    }
    if (!client.is_open()) std::abort();
  }
};

void seal_datagram(benchmark::State& state) {
  Pair pair;
  pair.shake();
  const Bytes plain(static_cast<std::size_t>(state.range(0)), 7);
  for (auto _ : state) benchmark::DoNotOptimize(pair.client.seal(plain));
}
BENCHMARK(seal_datagram)->Arg(30)->Arg(1200);

void open_datagram(benchmark::State& state) {
  Pair pair;
  pair.shake();
  const Bytes plain(static_cast<std::size_t>(state.range(0)), 7);
  for (auto _ : state) {
    state.PauseTiming();
    const auto sealed = pair.client.seal(plain).value();
    state.ResumeTiming();
    if (!pair.server.open(pair.now += kPause, kClient, sealed)) return state.SkipWithError("not opened");
  }
}
BENCHMARK(open_datagram)->Arg(30)->Arg(1200);

/// Sealed and opened, without pauses of the clock in between.
void seal_and_open(benchmark::State& state) {
  Pair pair;
  pair.shake();
  const Bytes plain(static_cast<std::size_t>(state.range(0)), 7);
  for (auto _ : state)
    if (!pair.server.open(pair.now += kPause, kClient, pair.client.seal(plain).value())) return state.SkipWithError("not opened");
}
BENCHMARK(seal_and_open)->Arg(30)->Arg(1200);

void handshake(benchmark::State& state) {
  std::vector<double> steps;
  for (auto _ : state) {
    Pair pair;
    pair.shake();
    steps.insert(steps.end(), pair.steps.begin(), pair.steps.end());
  }
  std::sort(steps.begin(), steps.end());
  const auto at = [&](double fraction) {
    return steps[static_cast<std::size_t>(fraction * static_cast<double>(steps.size() - 1))];
  };
  state.counters["steps"] = static_cast<double>(steps.size()) / static_cast<double>(state.iterations());
  state.counters["step_p50_us"] = at(0.5);
  state.counters["step_p99_us"] = at(0.99);
  state.counters["step_max_us"] = at(1);
}
BENCHMARK(handshake)->Unit(benchmark::kMicrosecond);

/// A first ClientHello, which is answered with a cookie.
void cookie(benchmark::State& state) {
  Pair pair;
  const auto message = pair.client.poll_datagram().value();
  const Bytes hello(message.begin(), message.end());
  for (auto _ : state) {
    static_cast<void>(pair.server.open(pair.now += kPause, kClient, hello));
    if (!pair.server.poll_datagram()) return state.SkipWithError("no answer");
  }
}
BENCHMARK(cookie);

/// A record that looks right and is not authentic.
void forgery(benchmark::State& state) {
  Pair pair;
  pair.shake();
  const auto sealed = pair.client.seal(Bytes(30, 7)).value();
  Bytes forged(sealed.begin(), sealed.end());
  forged.back() ^= 1u;
  for (auto _ : state) benchmark::DoNotOptimize(pair.server.open(pair.now += kPause, kClient, forged));
}
BENCHMARK(forgery);

/// The same beyond the rate of its sender, a client.
void flood(benchmark::State& state) {
  Pair pair;
  pair.shake();
  const auto sealed = pair.client.seal(Bytes(30, 7)).value();
  const Bytes again(sealed.begin(), sealed.end());
  for (int i = 0; i < 10'000; ++i) static_cast<void>(pair.server.open(pair.now, kClient, again));
  const std::uint64_t before = pair.server.counters().limited;
  for (auto _ : state) benchmark::DoNotOptimize(pair.server.open(pair.now, kClient, again));
  if (pair.server.counters().limited - before != static_cast<std::uint64_t>(state.iterations())) state.SkipWithError("handled");
}
BENCHMARK(flood);

/// And of hosts without a client.
void strangers_flood(benchmark::State& state) {
  Pair pair;
  pair.shake();
  std::vector<net::Address> hosts;
  for (int i = 0; i < 200; ++i) hosts.push_back(net::Address::parse("198.51.100." + std::to_string(i) + ":4000").value());
  const Bytes hello(150, 22);
  std::size_t next = 0;
  for (int i = 0; i < 20'000; ++i) static_cast<void>(pair.server.open(pair.now, hosts[next++ % 200], hello));
  for (auto _ : state) benchmark::DoNotOptimize(pair.server.open(pair.now, hosts[next++ % 200], hello));
}
BENCHMARK(strangers_flood);

}  // namespace
}  // namespace tactus
