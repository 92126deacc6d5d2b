// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/simulation.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/property/allocated.h"

namespace tactus::sim {
namespace {

Scene shipped(const std::string& name) {
  const auto path = find_scene(name);
  EXPECT_TRUE(path);
  const auto scene = load_scene(*path);
  EXPECT_TRUE(scene) << to_string(scene.error());
  return *scene;
}

SimulationOptions with_channel(std::uint64_t seed, double weber_fraction) {
  SimulationOptions options{.seed = seed, .grip = {}, .channel = ChannelOptions{}};
  options.channel->sender.triggers.weber_fraction = weber_fraction;
  return options;
}

/// FNV-1a over the bits of everything in a frame.
class FrameHash {
 public:
  void add(const TraceFrame& frame) {
    add(static_cast<std::uint64_t>(frame.tick));
    for (const RigidSample& o : frame.objects) {
      const Quat& q = o.pose.rotation;
      for (const Vec3& v : {o.pose.position, o.velocity, o.angular_velocity}) add(v);
      for (const double part : {q.w, q.x, q.y, q.z}) add(std::bit_cast<std::uint64_t>(part));
    }
    for (const UserSample& u : frame.users) {
      add(static_cast<std::uint64_t>(u.contact.kind));
      for (const Vec3& v : {u.contact.point, u.contact.normal, u.device.position, u.force, u.server_force}) add(v);
    }
  }
  std::uint64_t value() const { return hash_; }

 private:
  void add(std::uint64_t word) { hash_ = (hash_ ^ word) * 0x100000001B3u; }
  void add(const Vec3& v) {
    for (const double part : {v.x, v.y, v.z}) add(std::bit_cast<std::uint64_t>(part));
  }
  std::uint64_t hash_ = 0xCBF29CE484222325u;
};

std::uint64_t hash_of_run(const Scene& scene, const SimulationOptions& options, std::int64_t ticks) {
  auto simulation = Simulation::create(scene, options);
  EXPECT_TRUE(simulation);
  FrameHash hash;
  for (std::int64_t i = 0; i < ticks; ++i) {
    EXPECT_TRUE(simulation->step());
    hash.add(simulation->frame());
  }
  return hash.value();
}

TEST(Simulation, SameSeedSameBitsOtherSeedOtherBits) {
  const Scene scene = shipped("rotate-6dof");
  for (const bool channel : {false, true}) {
    const auto run = [&](std::uint64_t seed) {
      SimulationOptions options = with_channel(seed, 0.08);
      if (!channel) options.channel.reset();
      return hash_of_run(scene, options, 6000);
    };
    const std::uint64_t first = run(1);
    EXPECT_EQ(first, run(1));
    EXPECT_NE(first, run(2));
  }
}

TEST(Simulation, OpenLoopRepeatsWhatItRecorded) {
  const Scene scene = shipped("rotate-push-lift");
  auto live = Simulation::create(scene, {.seed = 4, .grip = {}, .channel = {}});
  ASSERT_TRUE(live);
  auto again = Simulation::create(scene, {.seed = 99, .grip = {}, .channel = {}});
  ASSERT_TRUE(again);
  FrameHash recorded, replayed;
  std::vector<DeviceSample> devices(scene.users.size());
  for (std::int64_t i = 0; i < live->ticks(); ++i) {
    ASSERT_TRUE(live->step());
    for (std::size_t user = 0; user < devices.size(); ++user) devices[user] = live->frame().users[user].device;
    ASSERT_TRUE(again->step(devices));
    recorded.add(live->frame());
    replayed.add(again->frame());
  }
  EXPECT_EQ(recorded.value(), replayed.value());
}

TEST(Simulation, StepsAllocateNothingOnceOdeHasItsArenas) {
  auto simulation = Simulation::create(shipped("rotate-push-lift"), with_channel(1, 0.04));
  ASSERT_TRUE(simulation);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(simulation->step());
  const std::uint64_t before = testing::allocated_bytes();
  std::uint64_t packets = 0;
  for (int i = 0; i < 8000; ++i) {
    const auto packet = simulation->step();
    if (!packet) break;
    packets += packet->size();
  }
  EXPECT_EQ(testing::allocated_bytes() - before, 0u) << "operator new, that is everything but what ODE takes from malloc";
  EXPECT_GT(packets, 50u);
}

TEST(Simulation, ReplayRefusesWhatItCannotUse) {
  auto simulation = Simulation::create(shipped("push-1dof"));
  ASSERT_TRUE(simulation);
  const auto none = simulation->step({});
  ASSERT_FALSE(none);
  EXPECT_STREQ(none.error().error.rule, "R-API-5");
  std::vector<DeviceSample> samples(1);
  samples[0].position.y = std::nan("");
  const auto broken = simulation->step(samples);
  ASSERT_FALSE(broken);
  EXPECT_STREQ(broken.error().error.rule, "R-API-1");
}

TEST(Simulation, FrameHoldsOneInstant) {
  // The recorded server force is the one that the recorded contact yields at the recorded pose.
  auto simulation = Simulation::create(shipped("rotate-push-lift"), with_channel(2, 0.04));
  ASSERT_TRUE(simulation);
  int surface = 0, spring = 0;
  for (std::int64_t i = 0; i < simulation->ticks(); ++i) {
    ASSERT_TRUE(simulation->step());
    const TraceFrame& frame = simulation->frame();
    ASSERT_EQ(frame.tick, i);
    const UserSample& user = frame.users[0];
    if (user.contact.kind == ContactKind::none) {
      ASSERT_EQ(user.server_force, Vec3{});
      continue;
    }
    const Pose& pose = frame.objects[user.contact.object].pose;
    const Vec3 expected = contact_force(user.contact, pose);
    Vec3 part = user.server_force;
    if (user.contact.kind == ContactKind::surface) {
      ++surface;
      const Vec3 normal = rotate(pose.rotation, user.contact.normal);
      part = dot(part, normal) * normal;
    } else {
      ++spring;
    }
    ASSERT_LT(norm(user.server_force), 3.2) << "not clipped in this scene";
    ASSERT_LT(norm(part - expected), 1e-9);
  }
  EXPECT_GT(surface, 3000);
  EXPECT_GT(spring, 2000);
}

TEST(Simulation, WithoutInterpolationTheClientObeysTheHapticRule) {
  for (const char* name : {"push-1dof", "rotate-6dof", "rotate-push-lift"}) {
    const SimulationOptions options = with_channel(3, 0.04);
    const RigidTriggers& triggers = options.channel->sender.triggers;
    auto simulation = Simulation::create(shipped(name), options);
    ASSERT_TRUE(simulation);
    std::int64_t violations = 0, packets = 0, ticks_with_error = 0;
    for (std::int64_t i = 0; i < simulation->ticks(); ++i) {
      const auto packet = simulation->step();
      ASSERT_TRUE(packet) << packet.error().error.rule;
      packets += static_cast<std::int64_t>(packet->size());
      const TraceFrame& frame = simulation->frame();
      const Contact& contact = frame.users[0].contact;
      const Vec3 truth = contact_force(contact, frame.objects[0].pose);
      const Vec3 shown = contact_force(contact, simulation->client_poses()[0]);
      violations += haptic_ratio(triggers, truth, shown) > 1;
      ticks_with_error += norm(truth - shown) > 0;
    }
    EXPECT_EQ(violations, 0) << name;
    EXPECT_GT(ticks_with_error, simulation->ticks() / 10) << "data reduction must show, or the rule was not tried";
    EXPECT_GT(packets, 20) << name;
    EXPECT_LT(packets, simulation->ticks() / 10) << name;
  }
}

TEST(Simulation, ForceNeverExceedsTheDevice) {
  Scene scene = shipped("push-1dof");
  scene.users[0].device.max_force = 0.5;
  auto simulation = Simulation::create(scene);
  ASSERT_TRUE(simulation);
  double largest = 0;
  for (std::int64_t i = 0; i < simulation->ticks(); ++i) {
    ASSERT_TRUE(simulation->step());
    const UserSample& user = simulation->frame().users[0];
    largest = std::max({largest, norm(user.force), norm(user.server_force)});
  }
  EXPECT_NEAR(largest, 0.5, 1e-12);
}

TEST(Simulation, DataReductionReachesTheHand) {
  const Scene scene = shipped("push-1dof");
  SimulationOptions coarse = with_channel(1, 0.3);
  SimulationOptions direct = coarse;
  direct.channel.reset();
  EXPECT_NE(hash_of_run(scene, coarse, 3000), hash_of_run(scene, direct, 3000));
}

TEST(Simulation, SceneWithoutUsersIsJustPhysics) {
  Scene scene = shipped("rotate-6dof");
  scene.users.clear();
  scene.touch.reset();
  scene.objects[0].pose.position.z = 0.1;
  auto simulation = Simulation::create(scene, with_channel(1, 0.08));
  ASSERT_TRUE(simulation);
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(simulation->step());
  EXPECT_TRUE(simulation->frame().users.empty());
  EXPECT_TRUE(simulation->info().users.empty());
  EXPECT_NEAR(simulation->frame().objects[0].pose.position.z, 0.02, 1e-4);
}

TEST(Simulation, InfoDescribesTheFrames) {
  const Scene scene = shipped("push-1dof");
  auto simulation = Simulation::create(scene, {.seed = 12, .grip = Grip::firm, .channel = {}});
  ASSERT_TRUE(simulation);
  const TraceInfo info = simulation->info();
  EXPECT_EQ(info.tick_rate, 1000u);
  ASSERT_EQ(info.objects.size(), 1u);
  EXPECT_EQ(info.objects[0].dof, Dof::x);
  EXPECT_EQ(info.users, std::vector<TraceUser>{{"hand"}});
  EXPECT_EQ(info.source, "sim push-1dof seed 12");
  EXPECT_EQ(info.scene, scene.text);
  EXPECT_EQ(simulation->ticks(), 3000);
}

/// What the person did with the cube in one run.
struct Task {
  double contact_fraction = 0;  ///< of all ticks
  int flips = 0;
  double yaw = 0;       ///< [rad] all turns about the vertical, summed
  double highest = 0;   ///< [m]
  double farthest = 0;  ///< [m] largest x of the cube
  double miss = 0;      ///< [m] least horizontal distance from the goal
  Pose end;
};

/// Which face is up, 0..5; -1 while the cube is tilted.
int upper_face(const Quat& rotation) {
  int face = 0;
  for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    const double up = rotate(rotation, axis).z;
    if (std::abs(up) > 0.99) return up > 0 ? face : face + 3;
    ++face;
  }
  return -1;
}

Task run_task(const std::string& name, std::uint64_t seed) {
  const Scene scene = shipped(name);
  auto simulation = Simulation::create(scene, {.seed = seed, .grip = {}, .channel = {}});
  EXPECT_TRUE(simulation);
  Task task{.miss = 1, .end = {}};
  int up = upper_face(scene.objects[0].pose.rotation);
  for (std::int64_t i = 0; i < simulation->ticks(); ++i) {
    EXPECT_TRUE(simulation->step());
    const RigidSample& cube = simulation->frame().objects[0];
    const UserSample& user = simulation->frame().users[0];
    task.contact_fraction += user.contact.kind != ContactKind::none;
    task.yaw += std::abs(cube.angular_velocity.z) * kTick;
    task.highest = std::max(task.highest, cube.pose.position.z);
    task.farthest = std::max(task.farthest, cube.pose.position.x);
    const Vec3 left = scene.users[0].goal - cube.pose.position;
    task.miss = std::min(task.miss, std::hypot(left.x, left.y));
    const int face = upper_face(cube.pose.rotation);
    if (face >= 0 && face != up) {
      ++task.flips;
      up = face;
    }
  }
  task.contact_fraction /= static_cast<double>(simulation->ticks());
  task.end = simulation->frame().objects[0].pose;
  return task;
}

class Tasks : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(Tasks, Push1DofReachesTheEndPoint) {
  const Task task = run_task("push-1dof", GetParam());
  EXPECT_NEAR(task.end.position.x, 0.155, 0.006);
  EXPECT_GT(task.contact_fraction, 0.4);
  EXPECT_LT(task.contact_fraction, 0.7);
}

TEST_P(Tasks, Rotate6DofTurnsAndFlips) {
  const Task task = run_task("rotate-6dof", GetParam());
  EXPECT_EQ(task.flips, 3);
  EXPECT_GT(task.yaw, 1.5);
  EXPECT_GT(task.contact_fraction, 0.35);
  EXPECT_LT(task.contact_fraction, 0.6);
}

TEST_P(Tasks, RotatePushLiftBringsTheCubeToTheGoalAndBack) {
  const Task task = run_task("rotate-push-lift", GetParam());
  EXPECT_GE(task.flips, 2);
  EXPECT_GT(task.yaw, 0.5);
  EXPECT_LT(task.miss, 0.015);
  EXPECT_GT(task.highest, 0.045) << "lifted well clear of the floor";
  EXPECT_LT(std::hypot(task.end.position.x, task.end.position.y), 0.01) << "back at the start";
  EXPECT_NEAR(task.end.position.z, 0.02, 1e-3) << "and put down";
  EXPECT_GT(task.contact_fraction, 0.4);
  EXPECT_LT(task.contact_fraction, 0.6);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Tasks, ::testing::Range<std::uint64_t>(1, 11));

}  // namespace
}  // namespace tactus::sim
