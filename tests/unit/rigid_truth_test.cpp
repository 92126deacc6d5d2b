// SPDX-License-Identifier: Apache-2.0
/// What encoders of one scene share changes no byte, and what rests is not looked at.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include <tactus/base/paged_array.h>
#include <tactus/rigid/awake_objects.h>
#include <tactus/rigid/rigid_predictor.h>
#include <tactus/rigid/rigid_truth.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/sender.h>
#include "tests/property/allocated.h"
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

constexpr std::size_t kObjects = 12;

SharedScene many(bool is_smoothed, bool has_interest = false) {
  SceneBuilder builder(1000);
  if (has_interest) builder.interest(0.05, 0.3);
  for (std::size_t i = 0; i < kObjects; ++i)
    builder.rigid("body " + std::to_string(i), {}, {.dof = i == 3 ? Dof::none : Dof::all});
  builder.rigid_profile(is_smoothed ? RigidProfile::main : RigidProfile::thesis);
  return builder.motion({{0, 0, -9.81}, 2}).baselines(64).build().value();
}

/// Objects that move and rest by turns; some creep, one is static, and a probe touches one now and then.
class Yard {
 public:
  explicit Yard(std::uint64_t seed) : random_(seed) {
    for (std::size_t i = 0; i < kObjects; ++i) motions_.emplace_back(seed + i);
    until_.resize(kObjects);
    state_.resize(kObjects);
    samples.resize(kObjects);
  }
  void step(std::int64_t tick) {
    contacts.clear();
    moved.clear();
    for (std::uint32_t i = 0; i < kObjects; ++i) {
      if (i == 3) continue;
      if (tick >= until_[i]) {
        state_[i] = random_() % 3;
        until_[i] = tick + 20 + static_cast<std::int64_t>(random_() % 400);
        samples[i].velocity = samples[i].angular_velocity = {};
        moved.push_back(i);
      }
      if (state_[i] == 0) continue;
      if (state_[i] == 1) samples[i] = motions_[i].step(1e-3);
      else samples[i].pose.position.x += 1e-5;  // and says that it rests
      if (moved.empty() || moved.back() != i) moved.push_back(i);
    }
    if (tick % 500 < 120) contacts.push_back(testing::touch(5, samples[5].pose, 1e-3 + 1e-5 * static_cast<double>(tick % 500)));
  }
  Truth truth(bool names) const {
    Truth out{.objects = samples, .contacts = contacts};
    if (names) out.moved = moved;
    return out;
  }

  std::vector<RigidSample> samples;
  std::vector<Contact> contacts;
  std::vector<std::uint32_t> moved;

 private:
  std::mt19937_64 random_;
  std::vector<testing::Motion> motions_;
  std::vector<std::int64_t> until_;
  std::vector<std::uint64_t> state_;
};

SenderOptions options_of(Baseline baseline, double heartbeat) {
  SenderOptions out;
  out.triggers.heartbeat = heartbeat;
  out.triggers.visual_position = 2e-4;
  out.policy = {.key_interval = 0.7, .baseline = baseline};
  return out;
}

/// A sender that shares, and one alone that is given the same.
struct Pair {
  Sender sharing, alone;
  std::uint64_t seed;
  std::vector<std::uint64_t> unheard{};
  std::uint64_t number = 1;
};

bool are_equal(const Result<std::span<const Packet>>& a, const Result<std::span<const Packet>>& b) {
  return a && b && std::ranges::equal(*a, *b, [](const Packet& x, const Packet& y) {
           return std::ranges::equal(x.bytes, y.bytes) && x.number == y.number && x.updates == y.updates && x.reason == y.reason;
         });
}

/// in  names  the truth says what has moved;  looks  clients have interest, and viewpoints of their own
void compare(bool is_smoothed, bool names, bool looks = false) {
  const SharedScene scene = many(is_smoothed, looks);
  const SenderOptions chain = options_of(Baseline::previous, 0.3);
  const auto shared = SharedTruth::create(scene, chain).value();
  std::vector<Pair> pairs;
  for (std::uint64_t i = 0; i < 8; ++i) {
    const SenderOptions own = options_of(i < 5 ? Baseline::previous : Baseline::acknowledged, 0.3);
    pairs.push_back({Sender::create(scene, own, shared).value(), Sender::create(scene, own).value(), i});
    if (i == 4) pairs[i].sharing.set_bound_scale(2), pairs[i].alone.set_bound_scale(2);
  }
  Yard yard(7);
  std::mt19937_64 random(9);
  std::uint64_t packets = 0;
  for (std::int64_t tick = 0; tick < 3000; ++tick) {
    yard.step(tick);
    ASSERT_TRUE(shared->read(tick, yard.truth(names)));
    for (Pair& pair : pairs) {
      if (looks && pair.seed > 1) {  // two of them from nowhere
        const double turn = 1e-3 * static_cast<double>(tick) + static_cast<double>(pair.seed / 2);
        const std::vector<Vec3> viewpoints{{0.3 * std::sin(turn), 0.3 * std::cos(turn), 0}};
        pair.sharing.set_viewpoints(viewpoints), pair.alone.set_viewpoints(viewpoints);
      }
      const auto sent = pair.sharing.encode(tick, yard.truth(names), pair.number);
      ASSERT_TRUE(are_equal(sent, pair.alone.encode(tick, yard.truth(false), pair.number))) << tick << ' ' << pair.seed;
      for (const Packet& packet : *sent) pair.unheard.push_back(packet.number), ++packets;
      ASSERT_EQ(pair.sharing.state_hash(0), pair.alone.state_hash(0));
      pair.number += 1 + (random() % 8 == 0 ? pair.seed % 3 : 0);  // datagrams without packets
      if (pair.seed >= 5 && tick % 30 == 0) {
        for (const std::uint64_t number : pair.unheard)
          if (random() % 5 != 0) pair.sharing.acknowledge(0, number), pair.alone.acknowledge(0, number);
        pair.unheard.clear();
        const LinkState link{.ack_timeout = 40, .loss = tick % 900 < 300 ? 0.0 : 0.2};
        pair.sharing.set_link(link), pair.alone.set_link(link);
      }
      if (pair.seed == 2 && random() % 100 == 0) pair.sharing.forget_last(0), pair.alone.forget_last(0);
    }
  }
  EXPECT_GT(packets, looks ? 1000u : 3000u);
}

TEST(SharedTruth, EveryByteIsThatOfASenderAlone) {
  compare(false, false);
  compare(true, false);
  compare(false, true, true);
  compare(true, false, true);
}

TEST(SharedTruth, WhatIsNamedAsMovedIsWhatHasMoved) {
  compare(true, true);
  const SharedScene scene = many(false);
  Sender sender = Sender::create(scene, options_of(Baseline::previous, 0)).value();
  Yard yard(1);
  ASSERT_TRUE(sender.encode(0, {.objects = yard.samples}));
  yard.samples[0].pose.position.x = 1;
  ASSERT_TRUE(sender.encode(1, {.objects = yard.samples, .moved = std::span<const std::uint32_t>()})->empty());
  const std::vector<std::uint32_t> named{0, 3, 99};  // one is static, one is none
  ASSERT_EQ(sender.encode(2, {.objects = yard.samples, .moved = named})->size(), 1u);
}

/// A sender that misses ticks keeps its bounds all the same: it looks at what has moved since.
TEST(SharedTruth, WhoMissesTicksSeesWhatHasMovedMeanwhile) {
  const SharedScene scene = many(false);
  SenderOptions options = options_of(Baseline::previous, 0);
  options.triggers.visual_position = 1e-3;
  const auto shared = SharedTruth::create(scene, options).value();
  Sender sender = Sender::create(scene, options, shared).value();
  const RigidPredictor predictor(*scene);
  Yard yard(3);
  for (std::int64_t tick = 0; tick < 4000; ++tick) {
    yard.step(tick);
    ASSERT_TRUE(shared->read(tick, yard.truth(true)));
    if (tick % 7 < 4) continue;
    ASSERT_TRUE(sender.encode(tick, yard.truth(true)));
    for (const std::uint32_t i : scene->moving()) {
      const Pose shown = to_pose(predictor.pose(sender.object(i), tick), scene->grid.position);
      ASSERT_LE(norm(shown.position - yard.samples[i].pose.position), 1e-3) << tick << ' ' << i;
    }
  }
}

/// What was sent still moves where the truth has stopped: it is looked at until it is sent again, or comes to rest itself.
TEST(SharedTruth, APredictionThatMovesIsWatchedThoughTheTruthRests) {
  constexpr double kBound = 1e-3, kFriction = 0.2, kBraking = kFriction * 9.81;  // [m], 1, [m/s^2]
  for (const double braking : {0.0, kBraking}) {
    const SharedScene scene = SceneBuilder(1000).rigid("puck").motion({{0, 0, -9.81}, kFriction}).build().value();
    SenderOptions options = options_of(Baseline::previous, 0);
    options.triggers.visual_position = kBound;
    Sender sender = Sender::create(scene, options).value();
    const RigidPredictor predictor(*scene);
    RigidSample puck;
    puck.velocity.x = 1;
    for (std::int64_t tick = 0; tick < 1500; ++tick) {
      if (tick < 250) {
        puck.pose.position.x += 1e-3 * puck.velocity.x - 0.5e-6 * braking;
        puck.velocity.x -= 1e-3 * braking;
      } else {
        if (tick == 250) {
          EXPECT_EQ(sender.object(0).predictor, braking > 0 ? Predictor::slide : Predictor::linear);
        }
        puck.velocity = {};  // it sticks
      }
      ASSERT_TRUE(sender.encode(tick, {.objects = {&puck, 1}}));
      const Pose shown = to_pose(predictor.pose(sender.object(0), tick), scene->grid.position);
      ASSERT_LE(norm(shown.position - puck.pose.position), kBound) << tick << ' ' << braking;
    }
    EXPECT_GT(sender.object(0).tick, 250);
  }
}

TEST(SharedTruth, NarrowerBoundsWakeWhatRestsOutsideThem) {
  const SharedScene scene = testing::scene_of(1);
  SenderOptions options = options_of(Baseline::previous, 0);
  options.triggers.visual_position = 1e-3;
  Sender sender = Sender::create(scene, options).value();
  sender.set_bound_scale(4);
  RigidSample body;
  body.pose.position.x = 3e-3;
  for (std::int64_t tick = 0; tick < 10; ++tick) ASSERT_TRUE(testing::all(sender.encode(tick, {.objects = {&body, 1}})).empty());
  sender.set_bound_scale(1);
  EXPECT_EQ(testing::all(sender.encode(10, {.objects = {&body, 1}})).size(), 1u);
}

/// What is held has moved once, to rest, and once more when it goes on.
TEST(RigidTruth, WhatIsHeldRestsAndMovesAgain) {
  const SharedScene scene = testing::scene_of(3);
  HeldList held(*scene);
  RigidTruth truth(*scene, {}, held);
  std::vector<RigidSample> samples(3);
  const auto read = [&](std::int64_t tick) {
    held.begin();
    ASSERT_TRUE(truth.read(tick, samples, {}));
    held.end();
  };
  samples[2].velocity.x = 1;
  read(0);
  EXPECT_EQ(truth.moved().size(), 3u) << "nothing was known before";
  read(1);
  EXPECT_TRUE(truth.moved().empty());
  samples[0].pose.position.x = 0.5;
  const RigidSample good = samples[2];
  samples[2].pose.position.x = std::nan("");
  read(2);
  EXPECT_EQ(truth.moved().size(), 2u);
  EXPECT_TRUE(truth.is_held(2) && !truth.is_held(0));
  EXPECT_EQ(truth.state(2).velocity, Vec3i{});
  EXPECT_EQ(truth.samples()[2].velocity.x, 0);
  EXPECT_EQ(truth.samples()[0].pose.position.x, 0.5);
  read(3);
  EXPECT_TRUE(truth.moved().empty() && truth.is_held(2));
  samples[2] = good;
  read(4);
  EXPECT_EQ(truth.moved().size(), 1u);
  EXPECT_FALSE(truth.is_held(2));
  EXPECT_NE(truth.state(2).velocity, Vec3i{});
  EXPECT_STREQ(truth.read(5, std::span(samples).first(2), {}).error().rule, "R-API-5");
  EXPECT_EQ(truth.reads(), 5u);
}

TEST(AwakeObjects, AreInOrderAndWakeWhenTheirTimeComes) {
  AwakeObjects awake(6);
  for (const std::uint32_t i : {4u, 1u, 3u, 1u}) awake.wake(i);
  const auto listed = [&] { return std::vector<std::uint32_t>(awake.objects().begin(), awake.objects().end()); };
  EXPECT_EQ(listed(), (std::vector<std::uint32_t>{1, 3, 4}));
  awake.sleep(
      [](std::uint32_t i) { return i == 3 ? std::nullopt : std::optional<std::int64_t>(i == 1 ? 50 : AwakeObjects::kNever); });
  EXPECT_EQ(listed(), std::vector<std::uint32_t>{3});
  awake.wake_due(49);
  EXPECT_FALSE(awake.is_awake(1));
  awake.wake_due(50);
  EXPECT_EQ(listed(), (std::vector<std::uint32_t>{1, 3}));
  awake.sleep([](std::uint32_t) { return std::optional<std::int64_t>(90); });
  awake.wake(1);
  awake.sleep([](std::uint32_t) { return std::optional<std::int64_t>(70); });
  EXPECT_EQ(listed(), std::vector<std::uint32_t>{1}) << "its alarm would come too late";
}

TEST(PagedArray, CopiesShareWhatTheyHaveInCommon) {
  struct Value {
    int of = 0;
  };
  PagedArray<Value> a(100, 3, [](std::size_t i) { return Value{static_cast<int>(i)}; });
  PagedArray<Value> b = a, c = a;
  EXPECT_EQ(a.pages_in_use(), 13u);
  const std::uint64_t before = testing::allocated_bytes();
  b.set(50, {-1});
  c = b;
  b.set(51, {-2});
  c.set(99, {-3});
  EXPECT_EQ(testing::allocated_bytes(), before);
  EXPECT_EQ(a.pages_in_use(), 16u);
  EXPECT_EQ(a[50].of, 50);
  EXPECT_EQ(b[50].of, -1);
  EXPECT_EQ(c[51].of, 51);
  EXPECT_EQ(b[51].of, -2);
  EXPECT_EQ(c[99].of, -3);
  b = a;
  c = a;
  EXPECT_EQ(a.pages_in_use(), 13u) << "what nobody holds is free again";
}

}  // namespace
}  // namespace tactus
