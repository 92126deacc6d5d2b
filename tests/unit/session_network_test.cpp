// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/link/session_network.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <tactus/scene/scene_builder.h>

namespace tactus::sim {
namespace {

using CapturePoint = Sighting::CapturePoint;

/// What was seen, in order.
struct Seen {
  CapturePoint point;
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
    to->seen.push_back({s.point, s.user, s.time, {s.datagram.begin(), s.datagram.end()}});
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
  EXPECT_EQ(seen.front().point, CapturePoint::client_sends) << "the join";
  std::map<std::pair<CapturePoint, std::size_t>, std::uint64_t> count;
  for (std::size_t i = two->before; i < seen.size(); ++i) ++count[{seen[i].point, seen[i].user}];
  for (std::size_t user = 0; user < 2; ++user) {
    EXPECT_EQ((count[{CapturePoint::client_sends, user}]), network.uplink(user).sent);
    EXPECT_EQ((count[{CapturePoint::server_hears, user}]), network.uplink(user).arrived);
    EXPECT_EQ((count[{CapturePoint::server_sends, user}]), network.downlink(user).sent);
    EXPECT_EQ((count[{CapturePoint::client_hears, user}]), network.downlink(user).arrived);
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

// ==== what is lost is repaired ====

constexpr std::size_t kBodies = 12;

SharedScene many_bodies() {
  SceneBuilder builder;
  for (std::size_t i = 0; i < kBodies; ++i) builder.rigid("body " + std::to_string(i));
  return builder.baselines(64).build().value();
}

/// Bodies on circles whose motion turns back at different times, until `rest` from when on they stand.
std::vector<RigidSample> circling(std::int64_t tick, std::int64_t rest) {
  std::vector<RigidSample> out(kBodies);
  const double t = 1e-3 * static_cast<double>(std::min(tick, rest));
  for (std::size_t i = 0; i < kBodies; ++i) {
    const double k = static_cast<double>(i), phase = std::fmod(t + 0.07 * k, 0.8);
    const double angle = phase < 0.4 ? 5 * phase : 5 * (0.8 - phase), speed = tick >= rest ? 0 : phase < 0.4 ? 5 : -5;
    out[i].pose.position = {0.1 * std::cos(angle), 0.1 * std::sin(angle), 0.01 * k};
    out[i].velocity = {-0.1 * speed * std::sin(angle), 0.1 * speed * std::cos(angle), 0};
  }
  return out;
}

SenderOptions one_millimetre() {
  SenderOptions out;
  out.triggers.visual_position = 1e-3;
  out.triggers.haptic = HapticRule::off;
  return out;
}

struct Watched {
  std::int64_t judged = 0, over = 0, behind = 0;  // ticks shown, those with any body over its bound; sum of delays [ms]
  std::int64_t healed = -1;                       // tick at which the client had a state of after the last outage
  std::uint64_t wrong = 0, lost = 0;
  bool same = false;  // at the end
};

Watched watch(const NetworkOptions& options, std::int64_t ticks) {
  Watched out;
  const auto network = SessionNetwork::create(many_bodies(), 1, one_millimetre(), options).value();
  const auto& outages = options.downlink.outages;
  const std::int64_t back = outages.empty() ? -1 : outages.back().end / 1000;
  std::int64_t last = -1;
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    const auto bodies = circling(tick, ticks - 500);
    EXPECT_TRUE(network->to_server(tick, {}, {}));
    EXPECT_TRUE(network->to_clients(tick, {.objects = bodies}));
    SessionClient& client = network->client(0);
    const std::int64_t shown = client.shown_tick(network->now());
    if (out.healed < 0 && back >= 0 && client.receiver()->tick(0) >= back) out.healed = tick;
    if (shown <= last || shown < 1000) continue;
    last = shown;
    const auto truth = circling(shown, ticks - 500);
    bool over = false;
    for (std::uint32_t i = 0; i < kBodies; ++i) {
      const Pose pose = to_pose(client.receiver()->replica().pose(i, shown), client.receiver()->scene()->grid.position);
      over = over || norm(pose.position - truth[i].pose.position) > 1.001e-3;
    }
    ++out.judged;
    out.over += over ? 1 : 0;
    out.behind += tick - shown;
  }
  out.wrong = network->sent_to(0).wrong_states;
  out.lost = network->sent_to(0).lost + network->sent_by(0).lost;
  out.same = network->client(0).receiver()->state_hash(0) == network->server().state_hash(0, 0);
  return out;
}

NetworkOptions network_of(const LinkOptions& link) { return {.uplink = link, .downlink = link, .role = Role::observer}; }

TEST(SessionNetwork, WithoutLossNothingIsLate) {
  for (const Microseconds delay : {0, 20'000, 100'000, 150'000}) {
    const Watched seen = watch(network_of({.seed = 5, .delay = delay}), 5000);
    EXPECT_EQ(seen.over, 0);
    EXPECT_NEAR(static_cast<double>(seen.behind) / static_cast<double>(seen.judged), 30 + 1e-3 * static_cast<double>(delay), 1);
    EXPECT_EQ(seen.lost, 0u) << "what is on its way at tick 0 arrives, too";
    EXPECT_TRUE(seen.same);
  }
}

/// Ticks with any of the bodies over its bound, at a round trip of 40 ms.
TEST(SessionNetwork, WhatIsLostIsThereBeforeItsTickIsShown) {
  const auto over = [](double loss, std::uint64_t seed) {
    const Watched seen = watch(network_of({.seed = seed, .delay = 20'000, .loss = loss}), 8000);
    EXPECT_TRUE(seen.same) << loss << ", seed " << seed;
    EXPECT_EQ(seen.wrong, 0u);
    EXPECT_LT(static_cast<double>(seen.behind) / static_cast<double>(seen.judged), loss < 0.2 ? 160 : 250);
    return static_cast<double>(seen.over) / static_cast<double>(seen.judged);
  };
  for (const std::uint64_t seed : {101u, 102u}) {
    EXPECT_LE(over(0.01, seed), 0.002);
    EXPECT_LE(over(0.1, seed), 0.01);
    EXPECT_LE(over(0.3, seed), 0.05);
  }
}

TEST(SessionNetwork, ALongerPlayoutIsNeverWorse) {
  std::int64_t before = std::numeric_limits<std::int64_t>::max();
  for (const std::uint32_t delay : {20'000u, 60'000u, 100'000u, 200'000u, 400'000u}) {
    std::int64_t over = 0;
    for (const std::uint64_t seed : {9u, 10u, 11u}) {
      NetworkOptions options = network_of({.seed = seed, .delay = 20'000, .loss = 0.1});
      options.playout.fixed = delay;
      over += watch(options, 6000).over;
    }
    EXPECT_LE(over, before) << delay;
    if (delay == 100'000) {  // 3.1 times fewer over eight other seeds
      EXPECT_LE(2 * over, before) << "copies come in time";
    }
    before = over;
  }
  EXPECT_EQ(before, 0);
}

TEST(SessionNetwork, AfterAnOutageTheBodiesAreSoonRight) {
  for (const Microseconds length : {500'000, 2'000'000, 10'000'000}) {
    LinkOptions link{.seed = 11, .delay = 20'000, .loss = 0.02};
    link.outages = {{2'000'000, 2'000'000 + length}};
    const std::int64_t end = 2000 + length / 1000;
    const Watched seen = watch(network_of(link), end + 2500);
    EXPECT_GE(seen.healed, end) << length;
    EXPECT_LE(seen.healed, end + 200) << length;
    EXPECT_TRUE(seen.same) << length;
    EXPECT_EQ(seen.wrong, 0u) << length;
  }
}

}  // namespace
}  // namespace tactus::sim
