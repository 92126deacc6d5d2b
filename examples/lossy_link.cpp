// SPDX-License-Identifier: Apache-2.0
/// Server and client over a link that loses one packet in ten and takes 20 ms each way. Packets build on states that the client has
/// acknowledged, so no loss stops the stream, and what is not acknowledged is sent again. The client shows the tick of 50 ms ago: most
/// packets are there by then, and it interpolates over the gaps that losses leave. If the client cannot decode a packet, advice() says whether
/// to request a key packet.
#include <cmath>
#include <cstdio>
#include <deque>
#include <random>
#include <vector>

#include <tactus/tactus.h>

namespace {

constexpr int kDelay = 20;    // [ticks] = [ms], each way
constexpr int kPlayout = 50;  // [ticks] between truth and shown state

struct InFlight {
  int arrives = 0;
  std::uint64_t number = 0;  // sent along with the packet, which does not hold it
  std::vector<std::uint8_t> bytes;
};

struct Acknowledgement {
  int arrives = 0;
  std::size_t substream = 0;
  std::uint64_t number = 0;
};

tactus::RigidSample pendulum(int tick) {
  const double w = 6.28, t = tick * 1e-3;
  return {.pose = {{0.1 * std::sin(w * t), 0, 0}, {}}, .velocity = {0.1 * w * std::cos(w * t), 0, 0}, .angular_velocity = {}};
}

}  // namespace

int main() {
  const auto scene = tactus::SceneBuilder().rigid("pendulum").baselines(32).build();
  if (!scene) return 1;
  tactus::SenderOptions options;
  options.policy = {.key_interval = 0, .baseline = tactus::Baseline::acknowledged};
  auto sender = tactus::Sender::create(*scene, options);
  auto receiver = tactus::Receiver::create(*scene, {.replica = {.interpolation = tactus::Interpolation::playout}, .limits = {}});
  if (!sender || !receiver) return 1;
  sender->set_link({.ack_timeout = 2 * kDelay + 1, .loss = 0.1});  // as measured; here it is known

  std::mt19937_64 random(1);
  std::deque<InFlight> link;
  std::deque<Acknowledgement> back;
  int sent = 0, lost = 0, refused = 0, over = 0;
  for (int tick = 0; tick < 10000; ++tick) {
    for (; !back.empty() && back.front().arrives <= tick; back.pop_front())
      sender->acknowledge(back.front().substream, back.front().number);
    const tactus::RigidSample truth = pendulum(tick);
    const auto packets = sender->encode(tick, {.objects = {&truth, 1}});
    if (!packets) return 1;
    for (const tactus::Packet& packet : *packets) {
      ++sent;
      if (random() % 10 == 0) ++lost;
      else link.push_back({tick + kDelay, packet.number, {packet.bytes.begin(), packet.bytes.end()}});
    }
    for (; !link.empty() && link.front().arrives <= tick; link.pop_front()) {
      const auto decoded = receiver->push(link.front().number, link.front().bytes, tick);
      if (decoded) {
        back.push_back({tick + kDelay, decoded->substream, decoded->number});
      } else {
        ++refused;
        if (tactus::advice(decoded.error()) == tactus::Advice::request_key) sender->request_key();
      }
    }
    const int past = tick - kPlayout;
    const tactus::Pose shown = receiver->pose(0, past);
    const double error = tactus::norm(shown.position - pendulum(past).pose.position);
    if (past >= 0 && error > options.triggers.visual_position) ++over;
  }
  std::printf("%d packets sent, %d lost, %d of those that arrived were refused; over the bound in %.2f %% of the ticks\n", sent,
              lost, refused, 1e-2 * over);
  return refused == 0 ? 0 : 1;
}
