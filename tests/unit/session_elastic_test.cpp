// SPDX-License-Identifier: Apache-2.0
// Elastic bodies in sessions: what the client shows, and what it costs, whether the declared body is the true one or not.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <tactus/deformable/displacement.h>
#include <tactus/sim/link/session_network.h>
#include <tactus/sim/server.h>
#include <tactus/sim/simulation.h>

namespace tactus {
namespace {

constexpr double kVisual = 2.5e-4;

struct Trial {
  std::size_t frames = 0, outside = 0;  // compared; with a vertex over the visual bound
  std::uint64_t packets = 0, bytes = 0, datagrams = 0;
  double force_error = 0;  // [N] mean difference between the rendered force and the server's, from its own state
};

/// A scene over a network.   in  model_scale  times the true Young's modulus: what is declared to clients
Trial trial(const sim::Scene& scene, const sim::LinkOptions& link, std::int64_t ticks, double model_scale = 1) {
  sim::SessionNetwork* network = nullptr;
  sim::ChannelOptions channel;
  channel.client_model_scale = model_scale;
  channel.sender.deformable.thresholds = {.visual = kVisual, .weber_fraction = 0.025, .depth_floor = 2e-4};
  channel.coding.spring_modes = 48;
  channel.network = [&](SharedScene declared, std::size_t users,
                        const SenderOptions& sender) -> Result<std::unique_ptr<sim::Network>> {
    TACTUS_TRY(auto made, sim::SessionNetwork::create(std::move(declared), users, sender, {.uplink = link, .downlink = link}));
    network = made.get();
    return made;
  };
  auto simulation = sim::Simulation::create(scene, {.seed = 1, .grip = {}, .channel = channel});
  EXPECT_TRUE(simulation) << simulation.error().rule;
  const std::uint32_t rate = scene.deformables[0].rate;
  std::vector<std::vector<float>> truth;  // by frame
  Trial out;
  std::int64_t compared = -1;
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    EXPECT_TRUE(simulation->step());
    const UserSample& user = simulation->frame().users[0];
    out.force_error += norm(user.force - user.server_force) / static_cast<double>(ticks);
    if (tick % rate == 0) truth.push_back(simulation->frame().meshes[0].displacements);
    const std::int64_t shown = simulation->shown_tick(0), frame = shown / rate;
    if (shown < 0 || frame == compared) continue;
    compared = frame;
    ++out.frames;
    const auto displacements = network->client(0).receiver()->replica().displacements(0, shown);
    const std::vector<float>& u = truth[static_cast<std::size_t>(frame)];
    double farthest = 0;
    for (std::size_t v = 0; v < displacements.size(); ++v) {
      const Vec3 error = to_metres(displacements[v], 22) - Vec3{u[3 * v], u[3 * v + 1], u[3 * v + 2]};
      farthest = std::max(farthest, norm(error));
    }
    out.outside += farthest > kVisual ? 1u : 0u;
  }
  const Traffic& sent = network->sent_to(0);
  out.packets = sent.packets_sent;
  out.bytes = sent.payload_sent;
  out.datagrams = sent.datagrams_sent;
  return out;
}

sim::Scene membrane() { return sim::load_scene(*sim::find_scene("membrane-large")).value(); }

TEST(Elastic, OneWhoKnowsTheBodyNeedsHardlyAPacket) {
  const Trial knows = trial(membrane(), {.delay = 10'000}, 4000);
  EXPECT_GT(knows.frames, 150u);
  EXPECT_EQ(knows.outside, 0u);
  EXPECT_LE(knows.packets, 4u);
  const Trial ignorant = trial(membrane(), {.delay = 10'000}, 4000, 0);
  EXPECT_EQ(ignorant.outside, 0u);
  EXPECT_GT(ignorant.packets, 20 * knows.packets);
  EXPECT_LT(knows.datagrams, ignorant.datagrams / 3);
  EXPECT_LT(knows.force_error, 1.02 * ignorant.force_error) << "late by the same network, and no more than that";
}

/// The method that the program chooses, and a scene with friction in sub-steps of velocity Verlet.
TEST(Elastic, TheBodyStepsAsTheServerDoes) {
  sim::Scene implicit = membrane();
  implicit.deformables[0].method = "auto";
  for (const sim::Scene& scene : {implicit, sim::load_scene(*sim::find_scene("membrane")).value()}) {
    const Trial knows = trial(scene, {.delay = 10'000}, 4000);
    EXPECT_EQ(knows.outside, 0u);
    EXPECT_LE(knows.packets, 4u);
  }
}

/// Young's modulus is 10 % off: the bounds hold, and packets are fewer than without a body.
TEST(Elastic, AWrongBodyKeepsTheBounds) {
  const Trial wrong = trial(membrane(), {.delay = 10'000}, 4000, 1.1);
  const Trial ignorant = trial(membrane(), {.delay = 10'000}, 4000, 0);
  EXPECT_EQ(wrong.outside, 0u);
  EXPECT_LT(wrong.packets, ignorant.packets);
  EXPECT_LT(wrong.force_error, 1.05 * ignorant.force_error) << "the wrong body has a share in it, beside the network";
}

/// A user of whom the client knows nothing presses beside its own.
TEST(Elastic, AnotherUserKeepsTheBounds) {
  sim::Scene scene = membrane();
  sim::SceneUser other = scene.users[0];
  other.name = "other";
  for (sim::PathPhase& phase : other.path) phase.to.x = -phase.to.x;
  other.start.x = -other.start.x;
  scene.users.push_back(other);
  const Trial two = trial(scene, {.delay = 10'000}, 4000);
  EXPECT_EQ(two.outside, 0u);
  EXPECT_GT(two.packets, 10u);
}

TEST(Elastic, LossesLeadAstrayForARoundTripAtMost) {
  const Trial lossy = trial(membrane(), {.delay = 10'000, .jitter = 3'000, .loss = 0.05}, 4000);
  EXPECT_LT(lossy.outside, lossy.frames / 50);
  EXPECT_LE(lossy.packets, 20u);
}

}  // namespace
}  // namespace tactus
