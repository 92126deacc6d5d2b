// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/link/session_network.h>

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <vector>

#include <tactus/scene/scene_builder.h>

namespace tactus::sim {
namespace {

using Place = Sighting::Place;

/// What was seen, in order.
struct Seen {
  Place place;
  std::size_t user;
  std::uint64_t time;
  std::vector<std::uint8_t> bytes;
  friend bool operator==(const Seen&, const Seen&) = default;
};

SharedScene one_body() { return SceneBuilder().rigid("body").baselines(64).build().value(); }

struct Session {
  std::vector<Seen> seen{};
  std::size_t before = 0;  // tick 0
  std::unique_ptr<SessionNetwork> network{};
};

/// A second of a body that moves, seen by so many participants.
std::unique_ptr<Session> session(std::size_t users, std::uint64_t seed) {
  auto out = std::make_unique<Session>();
  const LinkOptions link{.seed = seed, .delay = 5'000, .jitter = 3'000, .loss = 0.05, .duplicates = 0.05};
  NetworkOptions options{.uplink = link, .downlink = link};
  options.observer = [to = out.get()](const Sighting& s) {
    to->seen.push_back({s.place, s.user, s.time, {s.datagram.begin(), s.datagram.end()}});
  };
  out->network = SessionNetwork::create(one_body(), users, {}, options).value();
  out->before = out->seen.size();
  std::vector<DeviceSample> devices(users);
  const std::vector<std::optional<DeviceContact>> contacts(users);
  RigidSample body;
  for (std::int64_t tick = 0; tick < 1000; ++tick) {
    const double x = 1e-6 * static_cast<double>(tick * tick);
    body.pose.position = {x, 0, 0};
    for (DeviceSample& device : devices) device.position = {0, x, 0};
    EXPECT_TRUE(out->network->to_server(tick, devices, contacts));
    EXPECT_TRUE(out->network->to_clients(tick, {.objects = std::span(&body, 1)}));
  }
  return out;
}

TEST(SessionNetwork, AnObserverSeesWhatTheLinksCount) {
  const auto two = session(2, 1);
  const std::vector<Seen>& seen = two->seen;
  const SessionNetwork& network = *two->network;
  ASSERT_GT(two->before, 0u);
  EXPECT_EQ(seen.front().place, Place::client_sends) << "the join";
  std::map<std::pair<Place, std::size_t>, std::uint64_t> count;
  for (std::size_t i = two->before; i < seen.size(); ++i) ++count[{seen[i].place, seen[i].user}];
  for (std::size_t user = 0; user < 2; ++user) {
    EXPECT_EQ((count[{Place::client_sends, user}]), network.uplink(user).sent);
    EXPECT_EQ((count[{Place::server_hears, user}]), network.uplink(user).arrived);
    EXPECT_EQ((count[{Place::server_sends, user}]), network.downlink(user).sent);
    EXPECT_EQ((count[{Place::client_hears, user}]), network.downlink(user).arrived);
    EXPECT_GT(network.uplink(user).lost + network.downlink(user).lost, 0u);
  }
  for (std::size_t i = 1; i < seen.size(); ++i) ASSERT_LE(seen[i - 1].time, seen[i].time);
}

TEST(SessionNetwork, TheSameSeedShowsTheSame) {
  const auto first = session(1, 7);
  EXPECT_EQ(first->seen, session(1, 7)->seen);
  EXPECT_NE(first->seen, session(1, 8)->seen);
}

TEST(SessionNetwork, ClientsThatLeaveAreGone) {
  const auto one = session(1, 1);
  ASSERT_EQ(one->network->status(0).state, SessionState::live);
  one->network->leave();
  EXPECT_EQ(one->network->status(0).state, SessionState::closed);
  EXPECT_EQ(one->network->server().status(0).state, SessionState::closed);
}

}  // namespace
}  // namespace tactus::sim
