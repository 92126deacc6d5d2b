// SPDX-License-Identifier: Apache-2.0
/// Recordings of other programs: odometry, frames that hang on each other, forces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <tactus/trace/mcap_writer.h>
#include <tactus/trace/messages.h>
#include <tactus/trace/ros_messages.h>
#include "tests/unit/trace_fixture.h"

namespace tactus {
namespace {

constexpr double kPi = std::numbers::pi;

Quat about_z(double angle) { return {std::cos(angle / 2), 0, 0, std::sin(angle / 2)}; }

void header(CdrWriter& out, std::string_view frame) {
  out.u32(1'700'000'000);  // not used
  out.u32(0);
  out.text(frame);
}

struct Hung {
  std::string_view parent, child;
  Pose pose;
};

Bytes transforms(const std::vector<Hung>& all) {
  Bytes message;
  CdrWriter out(message);
  out.u32(static_cast<std::uint32_t>(all.size()));
  for (const Hung& one : all) {
    header(out, one.parent);
    out.text(one.child);
    out.vec3(one.pose.position);
    out.quat(one.pose.rotation);
  }
  return message;
}

Bytes transform(const Hung& one) {
  Bytes message;
  CdrWriter out(message);
  header(out, one.parent);
  out.text(one.child);
  out.vec3(one.pose.position);
  out.quat(one.pose.rotation);
  return message;
}

Bytes odometry(const Pose& pose, const Twist& twist) {
  Bytes message;
  CdrWriter out(message);
  header(out, "odom");
  out.text("base");
  out.vec3(pose.position);
  out.quat(pose.rotation);
  for (int i = 0; i < 36; ++i) out.f64(i);
  out.vec3(twist.linear);
  out.vec3(twist.angular);
  for (int i = 0; i < 36; ++i) out.f64(-i);
  return message;
}

Bytes wrench(std::string_view frame, const Vec3& force) {
  Bytes message;
  CdrWriter out(message);
  header(out, frame);
  out.vec3(force);
  out.vec3({9, 9, 9});
  return message;
}

Bytes pose(const Pose& value) {
  Bytes message;
  encode_pose(message, 0, value);
  return message;
}

using Notes = std::vector<std::pair<std::string, std::string>>;

/// A recording that begins on an ordinary day.
class RosBag {
 public:
  RosBag& add(double ms, const std::string& topic, std::string_view schema, const Bytes& message) {
    if (!channels_.contains(topic)) {
      const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
      channels_[topic] = id;
      EXPECT_TRUE(out_.add(mcap::Schema{id, std::string(schema), "ros2msg", ""}));
      EXPECT_TRUE(out_.add(mcap::Channel{id, id, topic, "cdr", {}}));
    }
    const auto time = std::uint64_t{1'700'000'000'000'000'000} + static_cast<std::uint64_t>(1e6 * ms);
    out_.add(mcap::Message{channels_[topic], 0, time, time, message});
    return *this;
  }
  RosBag& tf(double ms, const std::vector<Hung>& all) { return add(ms, "/tf", kTransformsSchema, transforms(all)); }
  RosBag& force(double ms, std::string_view frame, const Vec3& force) {
    return add(ms, "/arm/wrench", kWrenchSchema, wrench(frame, force));
  }

  Result<TraceReader> open() {
    EXPECT_TRUE(out_.finish());
    return TraceReader::open(file_.path());
  }
  Result<TraceReader> open(const ReadOptions& options) {
    EXPECT_TRUE(out_.finish());
    auto reader = TraceReader::open(file_.path(), options);
    if (!reader) return tl::unexpected(reader.error().error);
    return std::move(*reader);
  }
  /// All but that of the clock, once everything was read.
  Notes notes() {
    auto reader = open();
    EXPECT_TRUE(reader);
    for (TraceFrame frame; reader && reader->next(frame).value_or(false);) {
    }
    Notes notes;
    for (const ReadNote& note : reader->notes())
      if (!note.what.starts_with("log times are the clock")) notes.emplace_back(note.where, note.what);
    return notes;
  }
  std::string rule() {
    const Reading reading = read_all(open());
    return reading.error ? reading.error->rule : "";
  }

 private:
  TempFile file_;
  mcap::Writer out_ = mcap::Writer::create(file_.path(), "ros2").value();
  std::map<std::string, std::uint16_t> channels_;
};

bool has(const std::vector<ReadNote>& notes, std::string_view where, std::string_view what) {
  return std::ranges::any_of(notes, [&](const ReadNote& note) { return note.where == where && note.what == what; });
}
bool has(const Notes& notes, std::string_view where, std::string_view what) {
  return std::ranges::find(notes, std::pair(std::string(where), std::string(what))) != notes.end();
}

void expect_near(const Vec3& a, const Vec3& b, double off = 1e-9) {
  EXPECT_LT(norm(a - b), off) << a.x << ' ' << a.y << ' ' << a.z;
}

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
    expect_near(user.force, {0, i + 0.9, 0});  // told 0.1 ms after the tick before, and 0.1 ms after this one
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

TEST(TraceRos, TreesThatChangeOrLoopAreFollowedOrToldOf) {
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

Bytes pose_in(std::string_view frame, const Pose& value) {
  Bytes message;
  CdrWriter out(message);
  header(out, frame);
  out.vec3(value.position);
  out.quat(value.rotation);
  return message;
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

/// A frame of 25 Hz that turns and carries a hand, beside forces of 1 kHz: at each tick all move as they are told between samples.
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
  for (std::size_t i = 40; i <= 960; ++i) {
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
  EXPECT_TRUE(has(reader->notes(), "/tool/pose", "1 sample missing: the rotation is 0, 0, 0, 0"));
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

// ==== variants that programs of others bring ====

constexpr std::uint64_t kDay = 1'700'000'000'000'000'000;  // [ns] when a RosBag begins

Bytes stamped_pose(double ms, std::string_view frame, const Pose& value) {
  Bytes message;
  CdrWriter out(message);
  const auto stamp = kDay + static_cast<std::uint64_t>(std::llround(1e6 * ms));
  out.u32(static_cast<std::uint32_t>(stamp / 1'000'000'000));
  out.u32(static_cast<std::uint32_t>(stamp % 1'000'000'000));
  out.text(frame);
  out.vec3(value.position);
  out.quat(value.rotation);
  return message;
}

Bytes along_x(double x) { return pose_in("world", {{x, 0, 0}, {}}); }
const std::string_view kPose = schema_name(MessageType::pose);

/// Everything that is told of a place, for people who look at a failure.
std::string all_of(const std::vector<ReadNote>& notes) {
  std::string text;
  for (const ReadNote& note : notes) text += note.where + ": " + note.what + " (" + note.first + ")\n";
  return text;
}

TEST(TraceRos, BurstsWithoutStampsAreSpreadEvenly) {
  RosBag bag;  // 100 per second, ten at once
  for (int i = 0; i < 200; ++i) bag.add(100 * (i / 10) + 0.1 * (i % 10), "/tool/pose", kPose, along_x(0.001 * i));
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().tick_rate, 100u);
  EXPECT_TRUE(has(reader->notes(), "/tool/pose",
                  "log times come in bursts of 10 and header stamps do not help: samples are spread evenly, 100 per second"))
      << all_of(reader->notes());
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 200u);
  for (std::size_t i = 0; i < 200; ++i) {
    expect_near(reading.frames[i].objects[0].pose.position, {0.001 * static_cast<double>(i), 0, 0}, 1e-6);
    expect_near(reading.frames[i].objects[0].velocity, {0.1, 0, 0}, 1e-4);
  }
}

TEST(TraceRos, ClocksOfDifferentLengthAreTold) {
  RosBag bag;  // stamps of a clock that is 5 % slow
  for (int i = 0; i < 200; ++i) bag.add(10 * i, "/tool/pose", kPose, stamped_pose(9.5 * i, "world", {{0.001 * i, 0, 0}, {}}));
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().tick_rate, 100u);
  EXPECT_TRUE(has(reader->notes(), "/tool/pose", "log times span 1.990 s, header stamps 1.891 s; check which clock is right"))
      << all_of(reader->notes());
  EXPECT_EQ(read_all(std::move(reader)).frames.size(), 200u);
}

TEST(TraceRos, ATopicThatBeginsLateAndOneOnTwoChannels) {
  const TempFile file;
  auto out = mcap::Writer::create(file.path(), "ros2").value();
  ASSERT_TRUE(out.add(mcap::Schema{1, std::string(kPose), "ros2msg", ""}));
  const char* topics[]{"/a/pose", "/a/pose", "/b/pose"};
  for (std::uint16_t id = 1; id <= 3; ++id) ASSERT_TRUE(out.add(mcap::Channel{id, 1, topics[id - 1], "cdr", {}}));
  for (std::uint64_t i = 0; i < 400; ++i) {
    const std::uint64_t time = kDay + 10'000'000 * i;
    out.add(mcap::Message{static_cast<std::uint16_t>(i < 200 ? 1 : 2), 0, time, time, along_x(0.001 * static_cast<double>(i))});
    if (i >= 300) out.add(mcap::Message{3, 0, time, time, along_x(1 + 0.002 * static_cast<double>(i - 300))});
  }
  ASSERT_TRUE(out.finish());
  auto reader = TraceReader::open(file.path());
  ASSERT_TRUE(reader);
  ASSERT_EQ(reader->info().objects.size(), 2u);
  EXPECT_TRUE(has(reader->notes(), "/a/pose", "comes on 2 channels; taken as one"));
  EXPECT_TRUE(has(reader->notes(), "/b/pose", "begins at 3.000 s; before, it stands at its first pose"));
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 400u);
  for (std::size_t i = 0; i < 400; ++i) {
    const double from = std::max(0.0, static_cast<double>(i) - 300);
    expect_near(reading.frames[i].objects[0].pose.position, {0.001 * static_cast<double>(i), 0, 0});
    expect_near(reading.frames[i].objects[1].pose.position, {1 + 0.002 * from, 0, 0});
    expect_near(reading.frames[i].objects[1].velocity, {i < 300 ? 0 : 0.2, 0, 0}, 1e-6);
  }
}

/// As TF_REPEATED_DATA warns of: 10 new poses per second, each sent five times.
TEST(TraceRos, CopiesAreLeftOut) {
  RosBag bag;
  for (int i = 0; i < 1000; ++i)
    bag.add(20 * i, "/tool/pose", kPose, stamped_pose(100 * (i / 5), "world", {{0.01 * (i / 5), 0, 0}, {}}));
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().tick_rate, 10u);
  EXPECT_TRUE(has(reader->notes(), "/tool/pose", "796 samples with the stamp and the value of the one before: left out"));
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 200u);
  for (std::size_t i = 2; i < 200; ++i) expect_near(reading.frames[i].objects[0].velocity, {0.1, 0, 0}, 1e-6);
  RosBag resting;  // its stamp stands still, and so does it: beside it something moves
  for (int i = 0; i < 300; ++i) {
    resting.add(10 * i, "/table/pose", kPose, stamped_pose(0, "world", {{5, 0, 0}, {}}));
    resting.add(10 * i, "/tool/pose", kPose, stamped_pose(10 * i, "world", {{0.001 * i, 0, 0}, {}}));
  }
  const Reading rest = read_all(resting.open());
  ASSERT_EQ(rest.frames.size(), 300u);
  expect_near(rest.frames[299].objects[0].pose.position, {5, 0, 0});
  expect_near(rest.frames[299].objects[1].pose.position, {0.299, 0, 0});
}

TEST(TraceRos, AStrayLogTimeIsTakenBetweenItsNeighbours) {
  for (const double stray : {-1.7e12, 86'400'000.0})  // [ms] 1970, and a day later
    for (const int which : {0, 50, 99}) {
      if (which != 50 && stray > 0) continue;  // a pause of a day
      RosBag bag;
      for (int i = 0; i < 100; ++i) bag.add(10 * i + (i == which ? stray : 0), "/tool/pose", kPose, along_x(0.001 * i));
      auto reader = bag.open();
      ASSERT_TRUE(reader);
      EXPECT_EQ(reader->info().tick_rate, 100u) << which;
      EXPECT_TRUE(has(reader->notes(), "", "1 message with a log time far from those around: taken between them"))
          << all_of(reader->notes());
      const Reading reading = read_all(std::move(reader));
      ASSERT_NEAR(static_cast<double>(reading.frames.size()), 100, which == 50 ? 0 : 1) << which;
      if (which != 50) continue;
      for (std::size_t i = 0; i < 100; ++i)
        expect_near(reading.frames[i].objects[0].pose.position, {0.001 * static_cast<double>(i), 0, 0});
    }
}

TEST(TraceRos, AStaticTransformThatChangesIsFollowed) {
  RosBag bag;
  const auto base = [](double y) { return transforms({{"world", "base", {{0, y, 0}, {}}}}); };
  for (int i = 0; i < 400; ++i) {
    if (i == 100) bag.add(1000, "/tf_static", kTransformsSchema, base(1));
    if (i == 250) bag.add(2500, "/tf_static", kTransformsSchema, base(2));
    bag.add(10 * i, "/tool/pose", kPose, pose_in("base", {{0.001 * i, 0, 0}, {}}));
  }
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_TRUE(has(reader->notes(), "frame base of /tf_static", "is told at 1.000 s; it holds from the beginning"));
  EXPECT_TRUE(has(reader->notes(), "frame base of /tf_static", "is told to have changed; it jumps then"));
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 400u);
  for (std::size_t i = 0; i < 400; ++i) {
    expect_near(reading.frames[i].objects[0].pose.position, {0.001 * static_cast<double>(i), i < 250 ? 1.0 : 2.0, 0});
    expect_near(reading.frames[i].objects[0].velocity, {0.1, 0, 0}, 1e-6);
  }
}

TEST(TraceRos, AVelocityThatIsLeftAtZeroIsNone) {
  for (const double speed : {0.0, 0.9}) {
    RosBag bag;
    for (int i = 0; i < 50; ++i) bag.add(10 * i, "/odom", kOdometrySchema, odometry({{0.01 * i, 0, 0}, {}}, {{speed, 0, 0}, {}}));
    auto reader = bag.open();
    ASSERT_TRUE(reader);
    EXPECT_EQ(
        has(reader->notes(), "twist of /odom", "is 0 throughout, though the object moves: velocities follow from the poses"),
        speed == 0);
    const Reading reading = read_all(std::move(reader));
    for (const TraceFrame& frame : reading.frames) expect_near(frame.objects[0].velocity, {speed == 0 ? 1 : speed, 0, 0}, 1e-6);
  }
}

TEST(TraceRos, PrefixesOfFramesAreFound) {
  RosBag bag;
  const Pose base{{1, 0, 0}, about_z(kPi / 2)};
  for (int i = 0; i < 10; ++i) {
    bag.add(10 * i, "/tf", kTransformsSchema, transforms({{"world", "r1/base", base}}));
    bag.add(10 * i, "/r2/tf", kTransformsSchema, transforms({{"world", "base", base}}));
    bag.add(10 * i, "/r1/tool/pose", kPose, pose_in("base", {{0.5, 0, 0}, {}}));
    bag.add(10 * i, "/r2/tool/pose", kPose, pose_in("r2/base", {{0.5, 0, 0}, {}}));
  }
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_TRUE(has(reader->notes(), "/r1/tool/pose", "frame 'base' is taken for 'r1/base' of /tf")) << all_of(reader->notes());
  EXPECT_TRUE(has(reader->notes(), "/r2/tool/pose", "frame 'r2/base' is taken for 'base' of /r2/tf"));
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 10u);
  for (const std::size_t i : {0u, 1u}) expect_near(reading.frames[5].objects[i].pose.position, {1, 0.5, 0});
}

TEST(TraceRos, TwoPublishersOfOnePoseAreTold) {
  RosBag bag;
  for (int i = 0; i < 100; ++i) bag.add(5 * i, "/tool/pose", kPose, along_x(0.001 * i + (i % 2)));
  const Notes notes = bag.notes();
  EXPECT_TRUE(has(
      notes, "/tool/pose",
      "its samples go to and fro between two places, up to 1 m apart, as of two publishers: let each have a topic of its own"));
  RosBag one;
  for (int i = 0; i < 100; ++i) one.add(5 * i, "/tool/pose", kPose, along_x(0.1 * std::sin(0.5 * i)));
  for (const auto& [where, what] : one.notes()) EXPECT_EQ(what.find("to and fro"), std::string::npos) << what;
}

/// Pauses: a pose rests over them, a force is held for as long as the gap, 0.1 s, and is 0 then.
TEST(TraceRos, WhatPausesForTenSeconds) {
  RosBag bag;
  for (int i = 0; i < 1500; ++i) {
    const bool is_paused = i >= 300 && i < 1300;
    if (!is_paused) bag.force(10 * i, "world", {0, 0, 2});
    if (!is_paused) bag.add(10 * i, "/tool/pose", kPose, along_x(0.001 * i));
    bag.add(10 * i, "/other/pose", kPose, along_x(3));
  }
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_TRUE(has(reader->notes(), "/tool/pose", "1 gap longer than 0.1 s, the largest 10.010 s: it rests there"));
  EXPECT_TRUE(has(reader->notes(), "/arm/wrench",
                  "1 gap longer than 0.1 s, the largest 10.010 s: the force is held for as long, then 0"));
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 1500u);
  for (std::size_t i = 0; i < 1500; ++i) {
    const bool is_paused = i >= 300 && i < 1300;
    expect_near(reading.frames[i].objects[0].pose.position, {0.001 * static_cast<double>(is_paused ? 299 : i), 0, 0});
    expect_near(reading.frames[i].objects[0].velocity, {is_paused ? 0 : 0.1, 0, 0}, 1e-6);
    expect_near(reading.frames[i].users[0].force, {0, 0, i >= 310 && i < 1300 ? 0.0 : 2.0});
  }
}

TEST(TraceRos, WhatIsNotUsedMayBeNotANumber) {
  RosBag bag;  // covariances and torques; a twist alone is missing
  for (int i = 0; i < 20; ++i) {
    Bytes message = odometry({{0.01 * i, 0, 0}, {}}, {{NAN, 0, 0}, {}});
    for (std::size_t byte = message.size() - 8; byte < message.size(); ++byte) message[byte] = 0xff;  // the last covariance
    bag.add(10 * i, "/odom", kOdometrySchema, message);
  }
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_TRUE(has(reader->notes(), "twist of /odom", "20 samples missing: a number is NaN or infinite"))
      << all_of(reader->notes());
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 20u);
  for (const TraceFrame& frame : reading.frames) expect_near(frame.objects[0].velocity, {1, 0, 0}, 1e-6);
}

TEST(TraceRos, StampsThatHelpNothingAreIgnored) {
  for (const double offset : {-1.7e12, 3.2e10, 0.0}) {  // [ms] time of a simulation, a year ahead, and a clock that was reset
    RosBag bag;
    for (int i = 0; i < 100; ++i)
      bag.add(10 * i, "/tool/pose", kPose,
              stamped_pose(offset + 10 * (offset == 0 ? i % 50 : i), "world", {{0.001 * i, 0, 0}, {}}));
    const Reading reading = read_all(bag.open());
    ASSERT_EQ(reading.frames.size(), 100u) << offset;
    for (std::size_t i = 0; i < 100; ++i)
      expect_near(reading.frames[i].objects[0].pose.position, {0.001 * static_cast<double>(i), 0, 0});
  }
}

TEST(TraceRos, NamesWithBlanksAndNoNames) {
  RosBag bag;
  for (int i = 0; i < 10; ++i) {
    bag.tf(10 * i, {{"the world", "my base", {{0, 1, 0}, {}}}});
    bag.add(10 * i, "/tool/pose", kPose, pose_in("my base", {{0.1, 0, 0}, {}}));
    bag.add(10 * i, "/robot/odom", kOdometrySchema, odometry({{0.01 * i, 0, 0}, {}}, {{1, 0, 0}, {}}));
  }
  const Reading reading = read_all(bag.open());
  ASSERT_EQ(reading.frames.size(), 10u);
  expect_near(reading.frames[5].objects[0].pose.position, {0.1, 1, 0});
}

/// What read --stamps, --gap and --rate ask for, and --strict.
TEST(TraceRos, OptionsOfReading) {
  const auto bag = [](RosBag& out) {  // header stamps at half the pace; 0.3 s are missing from 1 s on
    for (int i = 0; i < 200; ++i)
      if (i < 100 || i >= 130) out.add(10 * i, "/tool/pose", kPose, stamped_pose(20 * i, "world", {{0.001 * i, 0, 0}, {}}));
  };
  const auto read = [&](const ReadOptions& options) {
    RosBag out;
    bag(out);
    return out.open(options);
  };
  auto automatic = read({});
  ASSERT_TRUE(automatic);
  EXPECT_EQ(automatic->info().tick_rate, 100u);
  EXPECT_EQ(read_all(std::move(automatic)).frames.size(), 170u);
  auto stamps = read({.stamps = RosStamps::header});
  ASSERT_TRUE(stamps);
  EXPECT_EQ(stamps->info().tick_rate, 50u);
  EXPECT_TRUE(has(stamps->notes(), "/tool/pose", "header stamps taken: as asked for; they are of another clock, moved by -1.990 s")) << all_of(stamps->notes());
  const Reading by_stamps = read_all(std::move(stamps));
  ASSERT_EQ(by_stamps.frames.size(), 170u);
  expect_near(by_stamps.frames[50].objects[0].velocity, {0.05, 0, 0}, 1e-6);
  const Reading by_log = read_all(read({.stamps = RosStamps::log}));
  ASSERT_EQ(by_log.frames.size(), 170u);
  expect_near(by_log.frames[50].objects[0].velocity, {0.1, 0, 0}, 1e-6);
  const Reading over_the_gap = read_all(read({.gap = 0.5}));
  ASSERT_EQ(over_the_gap.frames.size(), 200u);
  expect_near(over_the_gap.frames[115].objects[0].pose.position, {0.115, 0, 0}, 1e-6);
  auto fine = read({.tick_rate = 1000});
  ASSERT_TRUE(fine);
  EXPECT_EQ(fine->info().tick_rate, 1000u);
  const Reading at_1000 = read_all(std::move(fine));
  ASSERT_EQ(at_1000.frames.size(), 991u + 691u);
  expect_near(at_1000.frames[555].objects[0].pose.position, {0.0555, 0, 0}, 1e-6);
  expect_near(at_1000.frames[555].objects[0].velocity, {0.1, 0, 0}, 1e-6);
}

/// An error of next() is told with the topic and the time.
TEST(TraceRos, ATimeBehindAllOthersIsTold) {
  RosBag bag;
  for (int i = 0; i < 20; ++i) bag.add(10 * i, "/tool/pose", kPose, along_x(0.001 * i));
  for (int i = 0; i < 20; ++i) bag.add(2.5e12 + 10 * i, "/tool/pose", kPose, along_x(0.001 * i));  // 79 years later
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  TraceFrame frame;
  Result<bool> more = true;
  while (more && *more) more = reader->next(frame);
  ASSERT_FALSE(more);
  EXPECT_EQ(more.error().rule, std::string_view("R-TRC-15"));
  EXPECT_EQ(reader->explain(more.error()).detail, "/tool/pose, at 2500000000 s: more than a trace can hold");
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
}  // namespace tactus
