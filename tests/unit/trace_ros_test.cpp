// SPDX-License-Identifier: Apache-2.0
/// Recordings of other programs: odometry, frames that hang on each other, forces.
#include <cmath>
#include <numbers>

#include "tests/unit/ros_bag.h"

namespace tactus::ros_bag {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(TraceRos, OdometryMovesAnObjectByItsOwnVelocity) {
  RosBag bag;
  for (int i = 0; i < 5; ++i)
    bag.add(10 * i, "/robot/odom", kOdometrySchema, odometry({{0.1 * i, 0, 0}, about_z(kPi / 2)}, {{2, 0, 0}, {0, 0, 3}}));
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().tick_rate, 100u);
  ASSERT_EQ(reader->info().objects.size(), 1u);
  EXPECT_EQ(reader->info().objects[0].name, "robot.odom");
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 5u);
  expect_near(reading.frames[3].objects[0].pose.position, {0.3, 0, 0});
  expect_near(reading.frames[3].objects[0].velocity, {0, 2, 0});  // the robot's ahead is the world's y
  expect_near(reading.frames[3].objects[0].angular_velocity, {0, 0, 3});
}

TEST(TraceRos, FramesAreObjectsInTheFrameThatHangsOnNone) {
  RosBag bag;
  bag.add(0, "/tf_static", kTransformsSchema, transforms({{"hand", "tip", {{0.1, 0, 0}, {}}}}));
  for (int i = 0; i < 6; ++i)
    bag.tf(i, {{"arm", "hand", {{1, 0, 0}, about_z(0.01 * i)}}, {"map", "arm", {{0, 0, 0.002 * i}, about_z(kPi / 2)}}});
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().tick_rate, 1000u);
  ASSERT_EQ(reader->info().objects.size(), 3u);
  std::map<std::string, std::size_t> number;
  for (std::size_t i = 0; i < 3; ++i) number[reader->info().objects[i].name] = i;
  ASSERT_TRUE(number.contains("hand") && number.contains("tip") && number.contains("arm"));
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 6u);
  const auto& objects = reading.frames[4].objects;
  expect_near(objects[number["arm"]].pose.position, {0, 0, 0.008});
  expect_near(objects[number["hand"]].pose.position, {0, 1, 0.008});
  const double turn = kPi / 2 + 0.04;
  expect_near(objects[number["tip"]].pose.position, {0.1 * std::cos(turn), 1 + 0.1 * std::sin(turn), 0.008});
  expect_near(objects[number["arm"]].velocity, {0, 0, 2});
  expect_near(objects[number["tip"]].angular_velocity, {0, 0, 10}, 1e-6);
  EXPECT_NEAR(objects[number["tip"]].velocity.z, 2, 1e-9);
}

TEST(TraceRos, AForceActsWhereItsFrameIs) {
  RosBag bag;
  for (int i = 0; i < 4; ++i) {
    bag.add(i, "/tracker", kTransformSchema, transform({"map", "tool", {{0.1 * i, 0, 0}, about_z(kPi / 2)}}));
    bag.force(i + 0.1, "tool", {i + 1.0, 0, 0});
  }
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  ASSERT_EQ(reader->info().users.size(), 1u);
  EXPECT_EQ(reader->info().users[0].name, "arm");
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 4u);
  expect_near(reading.frames[0].users[0].force, {0, 1, 0});  // the first, 0.1 ms later
  for (int i = 1; i < 4; ++i) {
    const UserSample& user = reading.frames[static_cast<std::size_t>(i)].users[0];
    expect_near(user.device.position, {0.1 * i, 0, 0});
    expect_near(user.force, {0, i + 0.9, 0});  // published 0.1 ms after the tick before, and 0.1 ms after this one
    expect_near(user.server_force, user.force);
  }
}

TEST(TraceRos, AForceOfAnUnknownFrameActsAtTheTopicBeside) {
  RosBag bag;
  for (int i = 0; i < 3; ++i) {
    bag.add(2 * i, "/arm/pose", schema_name(MessageType::pose), pose({{0, 0.1 * i, 0}, about_z(1)}));
    bag.force(2 * i, "sensor", {0, 0, 1});
    bag.force(2 * i + 1, "sensor", {0, 0, 2});
  }
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().tick_rate, 1000u);
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 6u);
  expect_near(reading.frames[5].users[0].device.position, {0, 0.2, 0});
  expect_near(reading.frames[5].users[0].force, {0, 0, 2});
  expect_near(reading.frames[4].users[0].force, {0, 0, 1});
}

TEST(TraceRos, ForcesAloneAreARecording) {
  RosBag bag;
  for (int i = 0; i < 10; ++i) bag.force(2 * i, "sensor", {0, 0, 0.5 * i});
  const Reading reading = read_all(bag.open());
  ASSERT_EQ(reading.frames.size(), 10u);
  EXPECT_TRUE(reading.frames[0].objects.empty());
  expect_near(reading.frames[9].users[0].force, {0, 0, 4.5});
}

TEST(TraceRos, TreesThatChangeOrLoopAreFollowedOrReported) {
  const Pose there{{1, 0, 0}, {}};
  EXPECT_EQ(RosBag().tf(0, {{"a", "b", there}}).tf(1, {{"a", "b", there}}).notes(), (Notes{{"", "frame 'a' is the world"}}));
  RosBag moved;
  for (int i = 0; i < 10; ++i)
    moved.tf(10 * i, {{"map", "hand", {{0, 1, 0}, {}}}, {i < 5 ? "map" : "hand", "cup", {{1, 0, 0}, {}}}});
  auto reader = moved.open();
  ASSERT_TRUE(reader);
  EXPECT_TRUE(has(reader->notes(), "frame cup of /tf", "hangs on another frame: hand, before on map; followed"));
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 10u);
  expect_near(reading.frames[4].objects[1].pose.position, {1, 0, 0});
  expect_near(reading.frames[5].objects[1].pose.position, {1, 1, 0});
  expect_near(reading.frames[5].objects[1].velocity, {});  // no speed across a jump
  RosBag loop;
  for (int i = 0; i < 3; ++i) loop.tf(i, {{"a", "b", there}, {"b", "c", there}, {"c", "a", there}});
  EXPECT_TRUE(has(loop.notes(), "b", "this frame hangs on itself by way of others: its transform is left out"));
}

TEST(TraceRos, NamesAreMadeFit) {
  const Pose there{{1, 0, 0}, {}};
  RosBag bag;
  bag.tf(0, {{"m", "a/b", there}, {"m", "a.b", there}, {"/m", "/c", there}, {"m", "m", there}, {"m", "", there}});
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  ASSERT_EQ(reader->info().objects.size(), 3u);
  EXPECT_EQ(reader->info().objects[0].name, "a.b");
  EXPECT_EQ(reader->info().objects[1].name, "a.b_2");
  EXPECT_EQ(reader->info().objects[2].name, "c");
  EXPECT_TRUE(has(reader->notes(), "frame a.b of /tf", "is called a.b_2"));
  EXPECT_EQ(RosBag().tf(0, {{"a", "a", there}}).rule(), "R-TRC-16");
  EXPECT_EQ(RosBag().tf(0, {{"m", "", there}}).rule(), "R-TRC-16");
  EXPECT_EQ(RosBag().tf(0, {}).rule(), "R-TRC-16");
}

TEST(TraceRos, AFrameThatBeginsLateStandsAtItsFirstPose) {
  RosBag bag;
  for (int i = 0; i < 5000; ++i) bag.tf(i, {{"a", "b", {{1, 0, 0}, {}}}});
  for (int i = 5000; i < 5010; ++i) bag.tf(i, {{"a", "b", {{1, 0, 0}, {}}}, {"a", "c", {{0, 0.001 * (i - 4999), 0}, {}}}});
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_TRUE(has(reader->notes(), "frame c of /tf", "begins at 5.000 s; before, it stands at its first pose"));
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 5010u);
  expect_near(reading.frames[0].objects[1].pose.position, {0, 0.001, 0});
  expect_near(reading.frames[5009].objects[1].pose.position, {0, 0.010, 0});
}

TEST(TraceRos, AFrameThatComesSeldomIsInterpolated) {
  RosBag bag;
  for (int i = 0; i < 2000; ++i) {
    bag.force(i, "tool", {0, 0, 1});
    if (i % 1000 == 500) bag.tf(i, {{"map", "tool", {{0.001 * i, 0, 0}, {}}}});
  }
  const Reading reading = read_all(bag.open());
  ASSERT_FALSE(reading.error);
  ASSERT_EQ(reading.frames.size(), 2000u);
  expect_near(reading.frames[0].users[0].device.position, {0.5, 0, 0});
  expect_near(reading.frames[1000].users[0].device.position, {1.0, 0, 0});
  expect_near(reading.frames[1999].users[0].device.position, {1.5, 0, 0});
}

TEST(TraceRos, ACommandBesideOdometryIsNotItsMotion) {
  Bytes command;
  encode_twist(command, 0, {{9, 9, 9}, {9, 9, 9}});
  RosBag bag;
  for (int i = 0; i < 3; ++i) {
    bag.add(10 * i, "/odom", kOdometrySchema, odometry({{0.1 * i, 0, 0}, {}}, {{2, 0, 0}, {}}));
    bag.add(10 * i, "/cmd_vel", schema_name(MessageType::twist), command);
  }
  const Reading reading = read_all(bag.open());
  ASSERT_EQ(reading.frames.size(), 3u);
  expect_near(reading.frames[2].objects[0].velocity, {2, 0, 0});
}

TEST(TraceRos, AForceBesideSeveralTopicsActsAtNoneOfThem) {
  RosBag bag;
  for (int i = 0; i < 3; ++i) {
    bag.add(i, "/left", schema_name(MessageType::pose), pose({{1, 0, 0}, {}}));
    bag.add(i, "/right", schema_name(MessageType::pose), pose({{2, 0, 0}, {}}));
    bag.add(i, "/wrench", kWrenchSchema, wrench("sensor", {0, 0, 1}));
  }
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().users[0].name, "wrench");
  const Reading reading = read_all(std::move(reader));
  ASSERT_FALSE(reading.frames.empty());
  expect_near(reading.frames.back().users[0].device.position, {0, 0, 0});
}

TEST(TraceRos, APoseIsInItsFrame) {
  RosBag bag;
  bag.add(0, "/tf_static", kTransformsSchema,
          transforms({{"world", "left_base", {{0, 0.5, 0}, {}}}, {"/world", "/right_base", {{0, -0.5, 0}, about_z(kPi / 2)}}}));
  for (int i = 0; i < 5; ++i) {
    bag.add(10 * i, "/left/pose", schema_name(MessageType::pose), pose_in("left_base", {{0.3, 0, 0}, {}}));
    bag.add(10 * i, "/right/pose", schema_name(MessageType::pose), pose_in("/right_base", {{0.3, 0, 0}, {}}));
  }
  const Reading reading = read_all(bag.open());
  ASSERT_EQ(reading.frames.size(), 5u);
  expect_near(reading.frames[2].objects[0].pose.position, {0.3, 0.5, 0});
  expect_near(reading.frames[2].objects[1].pose.position, {0, -0.2, 0});
}

TEST(TraceRos, EachNamespaceHasItsTree) {
  RosBag bag;
  for (int i = 0; i < 5; ++i) {
    bag.add(10 * i, "/r1/tf", kTransformsSchema, transforms({{"odom", "base", {{1, 0, 0}, {}}}}));
    bag.add(10 * i, "/r2/tf", kTransformsSchema, transforms({{"odom", "base", {{2, 0, 0}, {}}}}));
    bag.add(10 * i, "/r2/arm/pose", schema_name(MessageType::pose), pose_in("base", {{0, 1, 0}, {}}));
  }
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  ASSERT_EQ(reader->info().objects.size(), 3u);
  EXPECT_EQ(reader->info().objects[1].name, "r1.base");
  EXPECT_EQ(reader->info().objects[2].name, "r2.base");
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 5u);
  expect_near(reading.frames[4].objects[0].pose.position, {2, 1, 0});
  expect_near(reading.frames[4].objects[1].pose.position, {1, 0, 0});
}

TEST(TraceRos, StampsAreTheClockWhereLogTimesComeInBursts) {
  RosBag bag;
  for (int i = 0; i < 200; ++i) {
    Bytes message;
    encode_pose(message, std::uint64_t{1'700'000'000'000'000'000} + std::uint64_t{1'000'000} * static_cast<std::uint64_t>(i),
                {{0.001 * i, 0, 0}, {}});
    bag.add(10 * (i / 10) + 10 + 0.02 * (i % 10), "/tool/pose", schema_name(MessageType::pose), message);
  }
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().tick_rate, 1000u);
  EXPECT_TRUE(has(reader->notes(), "/tool/pose", "header stamps taken: log times come in bursts of 10"));
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 200u);
  for (const TraceFrame& frame : reading.frames) expect_near(frame.objects[0].velocity, {1, 0, 0}, 1e-6);
}

/// A frame of 25 Hz that turns and carries a hand, beside forces of 1 kHz: at each tick all move as they are interpolated between samples.
TEST(TraceRos, WhatComesSeldomMovesSmoothly) {
  RosBag bag;
  const auto angle = [](double t) { return 0.5 * std::sin(2 * t); };
  for (int i = 0; i <= 1000; ++i) {
    bag.force(i, "sensor", {0, 0, 1});
    if (i % 40 != 0) continue;
    const double t = 0.001 * i;
    bag.tf(i, {{"map", "arm", {{0.3 * std::sin(3 * t), 0, 0}, about_z(angle(t))}}});
    bag.add(i, "/tool/pose", schema_name(MessageType::pose), pose_in("arm", {{0.4, 0, 0}, {}}));
  }
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().tick_rate, 1000u);
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 1001u);
  for (std::size_t i = 40; i < 960; ++i) {  // the first and the last stretch are lines
    const double t = 0.001 * static_cast<double>(i), a = angle(t), w = std::cos(2 * t);
    const auto& objects = reading.frames[i].objects;  // the tool, the arm
    expect_near(objects[1].angular_velocity, {0, 0, w}, 2e-3);
    expect_near(objects[1].velocity, {0.9 * std::cos(3 * t), 0, 0}, 5e-3);
    expect_near(objects[0].velocity, {0.9 * std::cos(3 * t) - 0.4 * w * std::sin(a), 0.4 * w * std::cos(a), 0}, 6e-3);
  }
}

TEST(TraceRos, ABadSampleIsMissing) {
  RosBag bag;
  for (int i = 0; i < 20; ++i)
    bag.add(10 * i, "/tool/pose", schema_name(MessageType::pose),
            pose_in("world", {{0.1 * i, 0, 0}, i == 7 ? Quat{0, 0, 0, 0} : Quat{i == 8 ? 0.985 : 1, 0, 0, 0}}));
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_TRUE(has(reader->notes(), "/tool/pose", "a sample is missing: the rotation is 0, 0, 0, 0"));
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 20u);
  expect_near(reading.frames[7].objects[0].pose.position, {0.7, 0, 0});
  EXPECT_EQ(reading.frames[8].objects[0].pose.rotation, Quat());
}

TEST(TraceRos, ClocksThatStepAndMessagesThatCross) {
  RosBag step;
  for (int i = 0; i < 100; ++i)
    step.add(i < 50 ? 10000 + 10 * i : 10 * i, "/a/pose", schema_name(MessageType::pose), pose({{0.1 * i, 0, 0}, {}}));
  const Reading stepped = read_all(step.open());
  ASSERT_FALSE(stepped.error);
  EXPECT_NEAR(static_cast<double>(stepped.frames.size()), 99, 1);
  for (std::size_t i = 1; i < stepped.frames.size(); ++i)
    EXPECT_GE(stepped.frames[i].objects[0].pose.position.x, stepped.frames[i - 1].objects[0].pose.position.x);
  RosBag cross;
  for (int i = 0; i < 50; ++i) cross.add(10 * i, "/a/pose", schema_name(MessageType::pose), pose({{0.1 * i, 0, 0}, {}}));
  for (int i = 0; i < 50; ++i) cross.force(10 * i, "f", {0, 0, 0.1 * i});  // topic after topic
  const Reading crossed = read_all(cross.open());
  ASSERT_EQ(crossed.frames.size(), 50u);
  expect_near(crossed.frames[20].objects[0].pose.position, {2, 0, 0});
  expect_near(crossed.frames[20].users[0].force, {0, 0, 2});
}

TEST(TraceRos, MessagesAreDistrusted) {
  const Bytes good = transforms({{"a", "b", {{1, 0, 0}, {}}}, {"a", "c", {{1, 0, 0}, {}}}});
  const auto rule = [](std::string_view schema, const Bytes& message) { return RosBag().add(0, "/t", schema, message).rule(); };
  EXPECT_EQ(rule(kTransformsSchema, good), "");
  EXPECT_EQ(rule(kTransformSchema, good), "R-TRC-13");
  for (std::size_t size = 4; size < good.size() - 3; ++size)
    EXPECT_EQ(rule(kTransformsSchema, Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size))), "R-TRC-13") << size;
  Bytes many = good;
  many[7] = 0xff;  // 4 000 000 000 transforms
  EXPECT_EQ(rule(kTransformsSchema, many), "R-TRC-13");
  EXPECT_EQ(rule(kTransformsSchema, transforms({{"a", "b", {{NAN, 0, 0}, {}}}})), "R-TRC-14");
  EXPECT_EQ(rule(kTransformsSchema, transforms({{"a", "b", {{1, 0, 0}, {0, 0, 0, 0}}}})), "R-TRC-14");
  EXPECT_EQ(rule(kTransformsSchema, transforms({{"a", "b", {{1, 0, 0}, {NAN, 0, 0, 0}}}})), "R-TRC-14");
  EXPECT_EQ(rule(kOdometrySchema, odometry({}, {{INFINITY, 0, 0}, {}})), "");  // the pose counts
  EXPECT_EQ(rule(kOdometrySchema, odometry({{}, {2, 0, 0, 0}}, {})), "R-TRC-14");
  EXPECT_EQ(rule(kWrenchSchema, wrench("f", {0, NAN, 0})), "R-TRC-14");
  EXPECT_EQ(rule(kWrenchSchema, Bytes(3)), "R-TRC-7");
}

}  // namespace
}  // namespace tactus::ros_bag
