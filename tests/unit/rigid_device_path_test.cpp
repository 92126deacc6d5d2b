// SPDX-License-Identifier: Apache-2.0
/// The path of a device that both ends know.
#include <gtest/gtest.h>

#include <cmath>

#include <tactus/rigid/device_path.h>
#include <tactus/scene/scene_builder.h>
#include "tests/unit/driven_fixture.h"

namespace tactus {
namespace {

using testing::device_state;
using testing::driven_scene;

struct Path : DevicePath {
  Path() : DevicePath(device_scene(*driven_scene()).value()) {}
  std::int64_t put(std::uint64_t number, std::int64_t tick, double x, double speed = 0) {
    return add(number, device_state(*scene(), tick, {x, 0, 0}, {speed, 0, 0}));
  }
  /// [mm] rounded; -1: not known.
  long x(std::int64_t tick) const {
    const auto at_tick = at(tick);
    return at_tick ? std::lround(1e3 * std::ldexp((*at_tick)[0], -22)) : -1;
  }
};

TEST(DevicePath, WithoutATickMappingOrAPacketThereIsNoState) {
  Path path;
  EXPECT_EQ(path.x(10), -1);
  path.put(1, 5, 0.001);
  EXPECT_EQ(path.x(10), -1);
  path.shift(20, 12);
  EXPECT_EQ(path.x(19), -1);
  EXPECT_EQ(path.x(20), 1);
  path.shift(21, 17);
  EXPECT_EQ(path.x(21), 1) << "the device's tick does not fall";
  EXPECT_EQ(path.state_at(21)->tick, 8);
  EXPECT_EQ(path.state_at(25)->tick, 8);
  EXPECT_EQ(path.state_at(26)->tick, 9);
}

TEST(DevicePath, PacketsActFromTheirTickOn) {
  Path path;
  path.shift(0, 10);
  path.put(3, 5, 0.001, 1.0);
  path.put(4, 8, 0.050);
  EXPECT_EQ(path.x(14), -1);
  EXPECT_EQ(path.x(15), 1);
  EXPECT_EQ(path.x(17), 3) << "dead reckoning";
  EXPECT_EQ(path.x(18), 50);
}

TEST(DevicePath, ReorderedPacketsTakeTheirSlot) {
  Path path;
  path.shift(0, 0);
  path.put(1, 1, 0.001);
  path.put(4, 4, 0.004);
  path.put(5, 5, 0.005);
  EXPECT_EQ(path.put(2, 2, 0.002), 3);
  for (const int tick : {1, 2, 3, 4, 5}) EXPECT_EQ(path.x(tick), tick == 3 ? 2 : tick);
}

TEST(DevicePath, WhatComesTooLateIsLeftOut) {
  Path path;
  path.shift(0, 10);
  path.pass(25);
  EXPECT_EQ(path.put(1, 15, 0.001), 0);
  EXPECT_EQ(path.put(2, 9, 0.001), -6);
  EXPECT_EQ(path.put(3, 16, 0.003), 1);
  EXPECT_EQ(path.x(25), -1);
  EXPECT_EQ(path.x(26), 3);
}

TEST(DevicePath, WhatWasNotAcceptedDoesNotAct) {
  Path path;
  path.shift(0, 0);
  for (int i = 1; i <= 6; ++i) path.put(static_cast<std::uint64_t>(i), i, 1e-3 * i);
  const std::uint64_t before = path.revision();
  path.settle(4, [](std::uint64_t number) { return number != 3; });
  EXPECT_EQ(path.x(3), 2);
  EXPECT_EQ(path.x(4), 4);
  EXPECT_EQ(path.x(6), 6) << "not known yet";
  EXPECT_NE(path.revision(), before);
  const std::uint64_t after = path.revision();
  path.settle(4, [](std::uint64_t number) { return number != 3; });
  EXPECT_EQ(path.revision(), after) << "nothing new";
  path.settle(5, [](std::uint64_t) { return true; });
  EXPECT_EQ(path.x(3), 3) << "it came after all";
}

TEST(DevicePath, OlderTickMappingsAndPacketsAreForgotten) {
  Path path;
  path.shift(0, 0);
  for (std::uint64_t i = 1; i <= DevicePath::kPackets + 5; ++i) path.put(i, static_cast<std::int64_t>(i), 0.001);
  EXPECT_EQ(path.x(5), -1);
  EXPECT_EQ(path.x(6), 1);
  for (std::size_t i = 1; i <= DevicePath::kShifts; ++i) path.shift(static_cast<std::int64_t>(1000 + i), 0);
  EXPECT_EQ(path.x(900), -1);
  EXPECT_EQ(path.x(1001), 1);
  path.shift(1000, 500);
  EXPECT_EQ(path.state_at(1500)->tick, 1500) << "a tick mapping of the past is not taken";
}

/// Reordered by all that is kept: there is no slot for it.
TEST(DevicePath, TheOldestOfAFullPathIsNotTaken) {
  Path path;
  path.shift(0, 0);
  for (std::uint64_t i = 2; i < DevicePath::kPackets + 2; ++i) path.put(i, static_cast<std::int64_t>(i), 0.002);
  EXPECT_LE(path.put(1, 1, 0.001), 0);
  EXPECT_EQ(path.x(2), 2);
}

}  // namespace
}  // namespace tactus
