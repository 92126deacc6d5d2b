// SPDX-License-Identifier: Apache-2.0
/// Recordings of other programs that are odd: clocks, copies, strays, pauses, names; and how they can be read.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/unit/ros_bag.h"

namespace tactus::ros_bag {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(TraceRosStrange, BurstsWithoutStampsAreSpreadEvenly) {
  RosBag bag;  // 100 per second, ten at once
  for (int i = 0; i < 200; ++i) bag.add(100 * (i / 10) + 0.1 * (i % 10), "/tool/pose", kPoseSchema, along_x(0.001 * i));
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

TEST(TraceRosStrange, ClocksOfDifferentLengthAreReported) {
  RosBag bag;  // stamps of a clock that is 5 % slow
  for (int i = 0; i < 200; ++i)
    bag.add(10 * i, "/tool/pose", kPoseSchema, stamped_pose(9.5 * i, "world", {{0.001 * i, 0, 0}, {}}));
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().tick_rate, 100u);
  EXPECT_TRUE(has(reader->notes(), "/tool/pose", "log times span 1.990 s, header stamps 1.891 s; check which clock is right"))
      << all_of(reader->notes());
  EXPECT_EQ(read_all(std::move(reader)).frames.size(), 200u);
}

TEST(TraceRosStrange, ATopicThatBeginsLateAndOneOnTwoChannels) {
  const TempFile file;
  auto out = mcap::Writer::create(file.path(), "ros2").value();
  ASSERT_TRUE(out.add(mcap::Schema{1, std::string(kPoseSchema), "ros2msg", ""}));
  const char* topics[]{"/a/pose", "/a/pose", "/b/pose"};
  for (std::uint16_t id = 1; id <= 3; ++id)  // two that say the same are one
    ASSERT_TRUE(out.add(mcap::Channel{id, 1, topics[id - 1], "cdr", {{"publisher", std::to_string(id)}}}));
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
TEST(TraceRosStrange, CopiesAreLeftOut) {
  RosBag bag;
  for (int i = 0; i < 1000; ++i)
    bag.add(20 * i, "/tool/pose", kPoseSchema, stamped_pose(100 * (i / 5), "world", {{0.01 * (i / 5), 0, 0}, {}}));
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().tick_rate, 10u);
  EXPECT_TRUE(has(reader->notes(), "/tool/pose", "a sample with the stamp and the value of the one before: left out", 796));
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 200u);
  for (std::size_t i = 2; i < 200; ++i) expect_near(reading.frames[i].objects[0].velocity, {0.1, 0, 0}, 1e-6);
  RosBag resting;  // its stamp stands still, and so does it: beside it something moves
  for (int i = 0; i < 300; ++i) {
    resting.add(10 * i, "/table/pose", kPoseSchema, stamped_pose(0, "world", {{5, 0, 0}, {}}));
    resting.add(10 * i, "/tool/pose", kPoseSchema, stamped_pose(10 * i, "world", {{0.001 * i, 0, 0}, {}}));
  }
  const Reading rest = read_all(resting.open());
  ASSERT_EQ(rest.frames.size(), 300u);
  expect_near(rest.frames[299].objects[0].pose.position, {5, 0, 0});
  expect_near(rest.frames[299].objects[1].pose.position, {0.299, 0, 0});
}

TEST(TraceRosStrange, AStrayLogTimeIsTakenBetweenItsNeighbours) {
  for (const double stray : {-1.7e12, 86'400'000.0})  // [ms] 1970, and a day later
    for (const int which : {0, 50, 99}) {
      if (which != 50 && stray > 0) continue;  // a pause of a day
      RosBag bag;
      for (int i = 0; i < 100; ++i) bag.add(10 * i + (i == which ? stray : 0), "/tool/pose", kPoseSchema, along_x(0.001 * i));
      auto reader = bag.open();
      ASSERT_TRUE(reader);
      EXPECT_EQ(reader->info().tick_rate, 100u) << which;
      EXPECT_TRUE(has(reader->notes(), "", "a message with a log time far from those around: taken between them"))
          << all_of(reader->notes());
      const Reading reading = read_all(std::move(reader));
      ASSERT_NEAR(static_cast<double>(reading.frames.size()), 100, which == 50 ? 0 : 1) << which;
      if (which != 50) continue;
      for (std::size_t i = 0; i < 100; ++i)
        expect_near(reading.frames[i].objects[0].pose.position, {0.001 * static_cast<double>(i), 0, 0});
    }
}

TEST(TraceRosStrange, AStaticTransformThatChangesIsFollowed) {
  RosBag bag;
  const auto base = [](double y) { return transforms({{"world", "base", {{0, y, 0}, {}}}}); };
  for (int i = 0; i < 400; ++i) {
    if (i == 100) bag.add(1000, "/tf_static", kTransformsSchema, base(1));
    if (i == 250) bag.add(2500, "/tf_static", kTransformsSchema, base(2));
    bag.add(10 * i, "/tool/pose", kPoseSchema, pose_in("base", {{0.001 * i, 0, 0}, {}}));
  }
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_TRUE(has(reader->notes(), "frame base of /tf_static", "is published at 1.000 s; it holds from the beginning"));
  EXPECT_TRUE(has(reader->notes(), "frame base of /tf_static", "is published with another value; it jumps then"));
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 400u);
  for (std::size_t i = 0; i < 400; ++i) {
    expect_near(reading.frames[i].objects[0].pose.position, {0.001 * static_cast<double>(i), i < 250 ? 1.0 : 2.0, 0});
    expect_near(reading.frames[i].objects[0].velocity, {0.1, 0, 0}, 1e-6);
  }
}

TEST(TraceRosStrange, AVelocityThatIsLeftAtZeroIsNone) {
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

TEST(TraceRosStrange, WhereNoVelocityIsPublishedItFollowsFromThePoses) {
  Bytes twist;
  encode_twist(twist, 0, {{3, 0, 0}, {}});
  RosBag bag;
  for (int i = 0; i < 200; ++i) {
    bag.add(10 * i, "/tool/pose", kPoseSchema, along_x(0.01 * i));
    if (i >= 50 && i < 100) bag.add(10 * i, "/tool/speed", schema_name(MessageType::twist), twist);
  }
  const Reading reading = read_all(bag.open());
  ASSERT_EQ(reading.frames.size(), 200u);
  for (std::size_t i = 0; i < 200; ++i)
    expect_near(reading.frames[i].objects[0].velocity, {i >= 50 && i < 100 ? 3.0 : 1.0, 0, 0}, 1e-6);
}

TEST(TraceRosStrange, PrefixesOfFramesAreFound) {
  RosBag bag;
  const Pose base{{1, 0, 0}, about_z(kPi / 2)};
  for (int i = 0; i < 10; ++i) {
    bag.add(10 * i, "/tf", kTransformsSchema, transforms({{"world", "r1/base", base}}));
    bag.add(10 * i, "/r2/tf", kTransformsSchema, transforms({{"world", "base", base}}));
    bag.add(10 * i, "/r1/tool/pose", kPoseSchema, pose_in("base", {{0.5, 0, 0}, {}}));
    bag.add(10 * i, "/r2/tool/pose", kPoseSchema, pose_in("r2/base", {{0.5, 0, 0}, {}}));
  }
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_TRUE(has(reader->notes(), "/r1/tool/pose", "frame 'base' is taken for 'r1/base' of /tf")) << all_of(reader->notes());
  EXPECT_TRUE(has(reader->notes(), "/r2/tool/pose", "frame 'r2/base' is taken for 'base' of /r2/tf"));
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 10u);
  for (const std::size_t i : {0u, 1u}) expect_near(reading.frames[5].objects[i].pose.position, {1, 0.5, 0});
}

TEST(TraceRosStrange, TwoPublishersOfOnePoseAreReported) {
  RosBag bag;
  for (int i = 0; i < 100; ++i) bag.add(5 * i, "/tool/pose", kPoseSchema, along_x(0.001 * i + (i % 2)));
  const Notes notes = bag.notes();
  EXPECT_TRUE(has(notes, "/tool/pose",
                  "its samples go to and fro between two positions, up to 1 m apart, as of two publishers: let each have a topic "
                  "of its own"));
  RosBag one;
  for (int i = 0; i < 100; ++i) one.add(5 * i, "/tool/pose", kPoseSchema, along_x(0.1 * std::sin(0.5 * i)));
  for (const auto& [where, what] : one.notes()) EXPECT_EQ(what.find("to and fro"), std::string::npos) << what;
}

/// Pauses: a pose rests over them, a force is held for as long as the gap, 0.1 s, and is 0 then.
TEST(TraceRosStrange, WhatPausesForTenSeconds) {
  RosBag bag;
  for (int i = 0; i < 1500; ++i) {
    const bool is_paused = i >= 300 && i < 1300;
    if (!is_paused) bag.force(10 * i, "world", {0, 0, 2});
    if (!is_paused) bag.add(10 * i, "/tool/pose", kPoseSchema, along_x(0.001 * i));
    bag.add(10 * i, "/other/pose", kPoseSchema, along_x(3));
  }
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_TRUE(has(reader->notes(), "/tool/pose", "a gap longer than 0.1 s, the largest 10.010 s: it rests there"));
  EXPECT_TRUE(has(reader->notes(), "/arm/wrench",
                  "a gap longer than 0.1 s, the largest 10.010 s: the force is held for as long, then 0"));
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 1500u);
  for (std::size_t i = 0; i < 1500; ++i) {
    const bool is_paused = i >= 300 && i < 1300;
    expect_near(reading.frames[i].objects[0].pose.position, {0.001 * static_cast<double>(is_paused ? 299 : i), 0, 0});
    expect_near(reading.frames[i].objects[0].velocity, {is_paused ? 0 : 0.1, 0, 0}, 1e-6);
    expect_near(reading.frames[i].users[0].force, {0, 0, i >= 310 && i < 1300 ? 0.0 : 2.0});
  }
}

TEST(TraceRosStrange, WhatIsNotUsedMayBeNotANumber) {
  RosBag bag;  // covariances and torques; a twist alone is missing
  for (int i = 0; i < 20; ++i) {
    Bytes message = odometry({{0.01 * i, 0, 0}, {}}, {{NAN, 0, 0}, {}});
    for (std::size_t byte = message.size() - 8; byte < message.size(); ++byte) message[byte] = 0xff;  // the last covariance
    bag.add(10 * i, "/odom", kOdometrySchema, message);
  }
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  EXPECT_TRUE(has(reader->notes(), "twist of /odom", "a sample is missing: a number is NaN or infinite", 20))
      << all_of(reader->notes());
  const Reading reading = read_all(std::move(reader));
  ASSERT_EQ(reading.frames.size(), 20u);
  for (const TraceFrame& frame : reading.frames) expect_near(frame.objects[0].velocity, {1, 0, 0}, 1e-6);
}

TEST(TraceRosStrange, StampsThatHelpNothingAreIgnored) {
  for (const double offset : {-1.7e12, 3.2e10, 0.0}) {  // [ms] time of a simulation, a year ahead, and a clock that was reset
    RosBag bag;
    for (int i = 0; i < 100; ++i)
      bag.add(10 * i, "/tool/pose", kPoseSchema,
              stamped_pose(offset + 10 * (offset == 0 ? i % 50 : i), "world", {{0.001 * i, 0, 0}, {}}));
    const Reading reading = read_all(bag.open());
    ASSERT_EQ(reading.frames.size(), 100u) << offset;
    for (std::size_t i = 0; i < 100; ++i)
      expect_near(reading.frames[i].objects[0].pose.position, {0.001 * static_cast<double>(i), 0, 0});
  }
}

TEST(TraceRosStrange, NamesWithBlanksAndNoNames) {
  RosBag bag;
  for (int i = 0; i < 10; ++i) {
    bag.tf(10 * i, {{"the world", "my base", {{0, 1, 0}, {}}}});
    bag.add(10 * i, "/tool/pose", kPoseSchema, pose_in(i % 2 == 0 ? "my base" : "//my base", {{0.1, 0, 0}, {}}));
    bag.add(10 * i, "/robot/odom", kOdometrySchema, odometry({{0.01 * i, 0, 0}, {}}, {{1, 0, 0}, {}}));
  }
  const Reading reading = read_all(bag.open());
  ASSERT_EQ(reading.frames.size(), 10u);
  expect_near(reading.frames[5].objects[0].pose.position, {0.1, 1, 0});
}

/// What read --stamps, --gap and --rate ask for, and --strict.
TEST(TraceRosStrange, OptionsOfReading) {
  const auto bag = [](RosBag& out) {  // header stamps at half the rate; 0.3 s are missing from 1 s on
    for (int i = 0; i < 200; ++i)
      if (i < 100 || i >= 130) out.add(10 * i, "/tool/pose", kPoseSchema, stamped_pose(20 * i, "world", {{0.001 * i, 0, 0}, {}}));
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
  EXPECT_TRUE(
      has(stamps->notes(), "/tool/pose", "header stamps taken: as asked for; they are of another clock, moved by -1.990 s"))
      << all_of(stamps->notes());
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

/// An error of next() is reported with the topic and the time.
/// As of a computer that began in 1970 and got the time while it recorded.
TEST(TraceRosStrange, AClockThatWasSetForwardGoesOnThere) {
  RosBag bag, same;
  for (RosBag* one : {&bag, &same})
    for (int i = 0; i < 40; ++i) {
      const double time = 10 * i + (i < 20 ? 0 : 2.5e12);  // 79 years later
      one->add(time, "/tool/pose", kPoseSchema, along_x(0.001 * i)).force(time, "sensor", {0, 0, 1});
    }
  EXPECT_TRUE(has(same.notes(), "", "the clock was set forward by 2500000000.010 s; what follows goes on there"));
  const Reading reading = read_all(bag.open());
  ASSERT_EQ(reading.frames.size(), 39u);  // the first sample behind the leap stands where the last one ahead of it stood
  EXPECT_EQ(reading.frames.back().tick, 38);
  EXPECT_NEAR(reading.frames.back().objects[0].pose.position.x, 0.039, 1e-7);
}

TEST(TraceRosStrange, ATimeBehindAllOthersIsReported) {
  RosBag bag;
  for (int i = 0; i < 120; ++i)  // from the twentieth on they are 0.9 years apart, as longer leaps are of the clock
    bag.add(10 * i + 2.8e10 * std::max(0, i - 20), "/tool/pose", kPoseSchema, along_x(0.001 * i));
  auto reader = bag.open();
  ASSERT_TRUE(reader);
  TraceFrame frame;
  Result<bool> more = true;
  while (more && *more) more = reader->next(frame);
  ASSERT_FALSE(more);
  EXPECT_EQ(more.error().rule, std::string_view("R-TRC-15"));
  const Diagnostic reported = reader->explain(more.error());
  EXPECT_EQ(reported.detail, "/tool/pose, at 2156000000 s");
  EXPECT_EQ(reported.cause, "times go on to more than the 2^31 s that a trace holds");
}

}  // namespace
}  // namespace tactus::ros_bag
