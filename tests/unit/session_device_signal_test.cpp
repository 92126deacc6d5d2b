// SPDX-License-Identifier: Apache-2.0
/// Devices as signals: what is sent.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <tactus/rigid/rigid_state.h>
#include <tactus/session/device_signal.h>
#include "tests/property/allocated.h"
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

/// A hand that reaches, tremors at 9 Hz and turns.
DeviceSample hand(std::int64_t tick) {
  const double t = 1e-3 * static_cast<double>(tick), angle = 0.8 * std::sin(1.7 * t);
  DeviceSample out;
  out.position = {0.08 * std::sin(2.1 * t) + 3e-4 * std::sin(56 * t), 0.05 * std::cos(3.3 * t),
                  0.02 * std::sin(0.9 * t) + 1e-4 * std::cos(57 * t)};
  out.orientation = {std::cos(angle / 2), 0, std::sin(angle / 2), 0};
  out.velocity = {0.168 * std::cos(2.1 * t) + 0.0168 * std::cos(56 * t), -0.165 * std::sin(3.3 * t),
                  0.018 * std::cos(0.9 * t) - 0.0057 * std::sin(57 * t)};
  return out;
}

/// Both ends of a device's channel; every packet arrives in its tick and is acknowledged.
struct Channel {
  explicit Channel(const DeviceCoding& coding, bool velocity = false, const GridExponents& grid = {})
      : scene(device_scene(*testing::shared(spec_with(grid))).value()),
        sender(Sender::create(scene, device_sender_options(coding)).value()),
        receiver(Receiver::create(scene).value()),
        truth(scene->tick_rate, velocity) {}
  static SceneSpec spec_with(const GridExponents& grid) {
    SceneSpec spec = testing::spec_of(3);
    spec.grid = grid;
    return spec;
  }

  DeviceSample send(std::int64_t tick, const DeviceSample& sample, const std::optional<DeviceContact>& contact = {}) {
    const auto sent = sender.encode(tick, truth.of(tick, sample, contact));
    EXPECT_TRUE(sent) << sent.error().rule;
    for (const Packet& packet : *sent) {
      EXPECT_TRUE(receiver.push(packet.number, packet.bytes));
      sender.acknowledge(packet.substream, packet.number);
      ++packets;
    }
    return device_at(receiver, tick, 0);
  }

  SharedScene scene;
  Sender sender;
  Receiver receiver;
  DeviceTruth truth;
  int packets = 0;
};

TEST(DeviceSignal, TheSceneOfADeviceIsOneBodyOnTheGridOfTheOther) {
  SceneSpec spec = testing::spec_of(5);
  spec.tick_rate = 500;
  spec.grid.position = 18;
  const SharedScene scene = device_scene(*testing::shared(std::move(spec))).value();
  EXPECT_EQ(scene->objects.size(), 1u);
  EXPECT_EQ(scene->tick_rate, 500u);
  EXPECT_EQ(scene->grid.position, 18);
  EXPECT_EQ(scene->baseline_span, 64);
  EXPECT_EQ(scene->max_extrapolation, 50) << "100 ms";
}

TEST(DeviceSignal, InFreeSpaceTheErrorIsWithinItsBoundAtEveryTick) {
  for (const bool velocity : {false, true}) {
    for (const double bound : {1e-5, 1e-4, 1e-3}) {
      Channel channel({.position = bound, .rotation = 0.02}, velocity);
      for (std::int64_t tick = 0; tick < 5000; ++tick) {
        const DeviceSample truth = hand(tick), shown = channel.send(tick, truth);
        ASSERT_LE(norm(shown.position - truth.position), bound) << tick;
        const Quat& a = shown.orientation;
        const Quat& b = truth.orientation;
        const double cosine = std::abs(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z);
        ASSERT_LE(2 * std::acos(std::min(1.0, cosine)), 0.02) << tick;
      }
      EXPECT_LT(channel.packets, bound < 5e-5 ? 5000 : 1500) << bound << ": most ticks need none";
      EXPECT_GT(channel.packets, 50) << bound;
    }
  }
}

TEST(DeviceSignal, InContactTheErrorOfTheForceIsWithinP) {
  for (const double p : {0.02, 0.04, 0.1}) {
    Channel channel({.position = 1e-3, .weber_fraction = p});
    constexpr double kFloor = 0.05;  // RigidTriggers::force_floor
    double worst = 0;
    for (std::int64_t tick = 0; tick < 5000; ++tick) {
      const DeviceSample truth = hand(tick);
      const double depth = 4e-3 * std::sin(1e-3 * static_cast<double>(tick));  // of the proxy before the device
      const DeviceContact contact{truth.position + Vec3{0, 0.6 * depth, 0.8 * depth}, 700};
      const DeviceSample shown = channel.send(tick, truth, contact);
      const Vec3 wanted = contact.stiffness * (contact.proxy - truth.position);
      const Vec3 applied = contact.stiffness * (contact.proxy - shown.position);
      const double ratio = norm(applied - wanted) / (p * std::max(norm(wanted), kFloor));
      worst = std::max(worst, ratio);
      ASSERT_LE(ratio, 1.0) << tick;
      ASSERT_LE(norm(shown.position - truth.position), 1e-3);
    }
    EXPECT_GT(worst, 0.7) << "the bound is used";
  }
}

TEST(DeviceSignal, ContactThatEndsIsForgotten) {
  Channel channel({.position = 1e-3, .weber_fraction = 0.02});
  const auto packets = [&](std::int64_t from, bool touches) {
    const int before = channel.packets;
    for (std::int64_t tick = from; tick < from + 2000; ++tick) {
      const DeviceSample truth = hand(tick);
      channel.send(tick, truth, touches ? std::optional(DeviceContact{truth.position + Vec3{0, 0, 1e-3}, 1000}) : std::nullopt);
    }
    return channel.packets - before;
  };
  const int free = packets(0, false), touching = packets(2000, true), again = packets(4000, false);
  EXPECT_GT(touching, 3 * free);
  EXPECT_LT(again, 2 * free);
}

TEST(DeviceSignal, EveryTickIsAsExactAsTheGrid) {
  Channel channel({.every_tick = true});
  for (std::int64_t tick = 0; tick < 2000; ++tick) {
    const DeviceSample truth = hand(tick), shown = channel.send(tick, truth);
    const double half = std::ldexp(0.5, -channel.scene->grid.position);
    ASSERT_LE(std::abs(shown.position.x - truth.position.x), half * 1.0001);
    ASSERT_LE(std::abs(shown.position.y - truth.position.y), half * 1.0001);
    ASSERT_LE(std::abs(shown.position.z - truth.position.z), half * 1.0001);
  }
  EXPECT_EQ(channel.packets, 2000);
}

TEST(DeviceSignal, AVelocityIsMadeFromPositions) {
  for (const bool senses : {false, true}) {
    Channel channel({.position = 1e-5, .every_tick = true}, senses);
    const Vec3 velocity{0.2, -0.1, 0.05};
    DeviceSample shown;
    for (std::int64_t tick = 100; tick < 200; ++tick) {
      const DeviceSample truth{.position = (1e-3 * static_cast<double>(tick)) * velocity, .velocity = {3, 3, 3}};
      shown = channel.send(tick, truth);
      if (senses) {
        ASSERT_LE(norm(shown.velocity - Vec3{3, 3, 3}), 1e-4);
      } else if (tick > 101) {
        ASSERT_LE(norm(shown.velocity - velocity), 1e-3) << tick;
      }
    }
  }
}

TEST(DeviceSignal, AVelocityIsThereWhateverTheTicks) {
  DeviceTruth truth(1000, false);
  EXPECT_EQ(norm(truth.of(5, {.position = {1, 2, 3}}, {}).objects[0].velocity), 0) << "of one sample";
  EXPECT_NEAR(truth.of(15, {.position = {1.1, 2, 3}}, {}).objects[0].velocity.x, 10, 1e-9) << "ticks may be left out";
  for (std::int64_t tick = 100'000; tick < 100'008; ++tick) truth.of(tick, {.position = {2, 2, 2}}, {});
  EXPECT_NEAR(norm(truth.of(100'008, {.position = {2, 2, 2}}, {}).objects[0].velocity), 0, 1e-9) << "old samples are forgotten";
}

TEST(DeviceSignal, TheVelocityLagsAsLittleAtEveryRate) {
  for (const std::uint32_t rate : {148u, 250u, 500u, 609u, 1000u, 4000u}) {
    DeviceTruth truth(rate, false);
    Vec3 velocity;
    double time = 0;
    for (std::int64_t tick = 0; tick < 100; ++tick) {
      time = static_cast<double>(tick) / rate;
      velocity = truth.of(tick, {.position = {0.5 * time * time, 0, 0}}, {}).objects[0].velocity;  // 1 m/s^2
    }
    const double lag = time - velocity.x;
    EXPECT_NEAR(lag, std::max(3.5e-3, 1.0 / rate), 6e-4) << rate << ": half of the window";
  }
}

TEST(DeviceSignal, WhatIsNotANumberSpoilsNothing) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Channel channel({});
    for (std::int64_t tick = 0; tick < 20; ++tick) channel.send(tick, hand(tick));
    DeviceSample wrong = hand(20);
    wrong.position.y = bad;
    ASSERT_TRUE(channel.sender.encode(20, channel.truth.of(20, wrong, {})));
    EXPECT_EQ(channel.sender.held().size(), 1u);
    for (std::int64_t tick = 21; tick < 40; ++tick) {
      const DeviceSample right = hand(tick);
      ASSERT_TRUE(channel.sender.encode(tick, channel.truth.of(tick, right, {})));
      EXPECT_TRUE(channel.sender.held().empty()) << "tick " << tick << " after a wrong one";
    }
  }
}

TEST(DeviceSignal, ADeviceThatIsNotHeardOfStandsStill) {
  Channel channel({.position = 1e-3}, true);
  for (std::int64_t tick = 0; tick < 100; ++tick)
    channel.send(tick, {.position = {1e-3 * static_cast<double>(tick), 0, 0}, .velocity = {1, 0, 0}});
  const std::int64_t newest = channel.receiver.tick(0);
  const DeviceSample soon = device_at(channel.receiver, newest + 50, 0b101);
  EXPECT_NEAR(soon.velocity.x, 1, 1e-4);
  EXPECT_NEAR(soon.position.x, 1e-3 * static_cast<double>(newest + 50), 1e-3);
  EXPECT_EQ(soon.buttons, 0b101u);
  const DeviceSample later = device_at(channel.receiver, newest + 100, 0),
                     much = device_at(channel.receiver, newest + 100'000, 0);
  EXPECT_EQ(norm(later.velocity), 0);
  EXPECT_EQ(norm(much.velocity), 0);
  EXPECT_EQ(norm(much.position - later.position), 0);
  EXPECT_NEAR(much.position.x, 1e-3 * static_cast<double>(newest + 100), 2e-3) << "it moved on for 100 ms";
}

TEST(DeviceSignal, AllocatesNothing) {
  Channel channel({});
  channel.send(0, hand(0));
  const std::uint64_t before = testing::allocated_bytes();
  for (std::int64_t tick = 1; tick < 500; ++tick)
    channel.send(tick, hand(tick), tick % 2 ? std::optional(DeviceContact{hand(tick).position, 500}) : std::nullopt);
  EXPECT_EQ(testing::allocated_bytes(), before);
}

}  // namespace
}  // namespace tactus
