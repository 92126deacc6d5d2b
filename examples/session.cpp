// SPDX-License-Identifier: Apache-2.0
/// A session: a server with one pendulum and a client that looks on, as in an engine with a tick of 1 ms. Both are functions of bytes and
/// time. The network between them takes 20 ms each way and loses one datagram in ten. The client interpolates over the gaps that losses leave;
/// the program prints how often what is shown was beyond the bound then, and how far. A longer playout delay makes that rarer.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include <tactus/session.h>

namespace {

constexpr std::int64_t kTicks = 10'000;  // of 1 ms
constexpr std::uint64_t kPeer = 1;       // the transport's name for the address of the client

class Network {
 public:
  explicit Network(unsigned seed) : random_(seed) {}
  void send(std::uint64_t now, std::span<const std::uint8_t> bytes) {
    if (random_() % 10 != 0) datagrams_.push_back({now + 20'000, {bytes.begin(), bytes.end()}});
  }
  std::optional<std::vector<std::uint8_t>> receive(std::uint64_t now) {
    if (datagrams_.empty() || datagrams_.front().arrives > now) return std::nullopt;
    std::vector<std::uint8_t> bytes = std::move(datagrams_.front().bytes);
    datagrams_.pop_front();
    return bytes;
  }

 private:
  struct Datagram {
    std::uint64_t arrives = 0;  // [us]
    std::vector<std::uint8_t> bytes;
  };
  std::mt19937 random_;
  std::deque<Datagram> datagrams_;
};

tactus::RigidSample pendulum(std::int64_t tick) {
  const double w = 6.28, t = 1e-3 * static_cast<double>(tick);
  return {.pose = {{0.1 * std::sin(w * t), 0, 0}, {}}, .velocity = {0.1 * w * std::cos(w * t), 0, 0}, .angular_velocity = {}};
}

}  // namespace

int main() {
  // Only the server declares the scene: the session brings it to the client. With baselines, packets are shorter while acknowledgements
  // are on their way.
  const auto scene = tactus::SceneBuilder().rigid("pendulum").baselines(64).build();
  if (!scene) return 1;
  tactus::SessionServerOptions options;
  options.sender.triggers.visual_position = 0.001;  // [m]
  std::random_device device;
  const auto entropy = [&] { return std::uint64_t{device()} << 32 | device(); };
  auto server = tactus::SessionServer::create(*scene, options, entropy(), 0);
  auto client = tactus::SessionClient::create({.role = tactus::Role::observer});
  if (!server || !client) return 1;
  client->open(0, entropy());

  Network up(1), down(2);
  std::int64_t shown = -1;
  int frames = 0, over = 0;
  double worst = 0;  // [m]
  for (std::int64_t tick = 0; tick < kTicks; ++tick) {
    const auto now = static_cast<std::uint64_t>(1000 * tick);  // [us] each end may have a clock of its own

    while (const auto bytes = up.receive(now)) (void)server->handle_datagram(now, kPeer, *bytes);  // what it refuses is as lost
    server->handle_timeout(now);
    const tactus::RigidSample truth = pendulum(tick);
    if (!server->submit(now, tick, {.objects = {&truth, 1}})) return 1;
    while (const auto datagram = server->poll_datagram(now)) down.send(now, datagram->bytes);  // there is only one peer
    while (const auto event = server->poll_event())
      if (event->kind == tactus::ServerEvent::Kind::live) std::printf("a client is live after %d ms\n", static_cast<int>(tick));

    while (const auto bytes = down.receive(now)) (void)client->handle_datagram(now, *bytes);
    client->handle_timeout(now);
    while (const auto datagram = client->poll_datagram(now)) up.send(now, *datagram);
    while (const auto event = client->poll_event())
      if (event->kind == tactus::ClientEvent::Kind::closed) return 1;
    shown = client->shown_tick(now);
    if (shown < 0) continue;  // nothing has come yet
    const tactus::Pose pose = client->pose(0, shown);
    const double error = tactus::norm(pose.position - pendulum(shown).pose.position);  // against the truth of the tick shown
    worst = std::max(worst, error);
    ++frames;
    if (error > options.sender.triggers.visual_position) ++over;
  }
  std::printf("%d frames, the last one %d ms behind the server\n", frames, static_cast<int>(kTicks - 1 - shown));
  std::printf("in %.2f %% of them over the bound of 1 mm, at most %.2f mm off\n", 100.0 * over / frames, 1e3 * worst);
  return frames > 0 && over < frames / 20 ? 0 : 1;
}
