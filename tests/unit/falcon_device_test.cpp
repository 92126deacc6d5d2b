// SPDX-License-Identifier: Apache-2.0
/// The driver of a Falcon.
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include <tactus/device/falcon/falcon_device.h>
#include <tactus/device/falcon/falcon_frame.h>
#include <tactus/device/falcon/falcon_kinematics.h>
#include <tactus/device/force_guard.h>
#include "tests/property/allocated.h"
#include "tests/unit/falcon_fixture.h"

namespace tactus::device::falcon {
namespace {

using testing::FakeBus;
using testing::FakeFalcon;

/// An open Falcon, and a guard whose slew limit lets every force pass at once.
class FalconDevice : public ::testing::Test {
 protected:
  std::unique_ptr<Device> opened() {
    const FalconBackend backend(std::make_unique<FakeBus>(falcon_));
    auto device = backend.open("", {});
    if (!device) ADD_FAILURE() << to_string(device.error());
    return *std::move(device);
  }
  Result<Reading> read(Time within = 5 * kMillisecond) { return device_->read(falcon_.now + within); }
  /// The answer to a write() is older than what was changed after it: the next one.
  Result<Reading> read_fresh() {
    static_cast<void>(read());
    return read();
  }
  Result<void> write(const Vec3& force) { return device_->write(guarded(force)); }
  GuardedForce guarded(const Vec3& force) {
    Reading fine;
    for (int i = 0; i < 2; ++i) guard_.pass({force, falcon_.now}, fine, falcon_.now + i * kMillisecond);
    return guard_.pass({force, falcon_.now}, fine, falcon_.now + 2 * kMillisecond);
  }
  /// What the motors do, as a force on the hand [N], device frame.
  Vec3 exerted(const Vec3& at) const {
    const Pose pose = pose_at(to_native(at)).value();
    const Triple torque = torques_of({static_cast<std::int16_t>(falcon_.motor(0)), static_cast<std::int16_t>(falcon_.motor(1)),
                                      static_cast<std::int16_t>(falcon_.motor(2))});
    const Vec3 f = torque[0] * pose.jacobian[0] + torque[1] * pose.jacobian[1] + torque[2] * pose.jacobian[2];
    return {f.x, -f.z, f.y};
  }
  void expect_ended(const Result<Reading>& result, const char* rule) {
    ASSERT_FALSE(result);
    EXPECT_STREQ(result.error().rule, rule);
    EXPECT_TRUE(falcon_.is_at_rest());
    const std::size_t frames = falcon_.frames.size();
    EXPECT_STREQ(read().error().rule, rule);
    EXPECT_STREQ(write({1, 0, 0}).error().rule, rule);
    EXPECT_EQ(falcon_.frames.size(), frames);
  }
  void move_to(const Vec3& position) {
    const Triple angles = pose_at(to_native(position))->angles;
    for (std::size_t i = 0; i < 3; ++i) falcon_.reply.counts[i] = static_cast<std::int16_t>(std::lround(count_of(angles[i])));
  }

  FakeFalcon falcon_;
  std::unique_ptr<Device> device_ = opened();
  ForceGuard guard_ = ForceGuard::create(device_->capabilities(), {0, 1e9, 10 * kMillisecond, false}).value();
};

TEST_F(FalconDevice, CapabilitiesAreNumbers) {
  const Capabilities& about = device_->capabilities();
  EXPECT_EQ(about.name, "falcon:0");
  EXPECT_EQ(about.serial, "F1");
  EXPECT_EQ(about.force_axes, 3u);
  EXPECT_TRUE(about.has_clock && about.senses.buttons);
  for (const Vec3& corner : {about.low, about.high}) EXPECT_TRUE(pose_at(to_native(corner)));
}

TEST_F(FalconDevice, TheHandleAndItsButtonsAreRead) {
  for (const Vec3& position : {Vec3{}, Vec3{0.03, -0.02, 0.01}, Vec3{-0.04, 0.04, -0.04}}) {
    move_to(position);
    falcon_.reply.buttons = 9;
    const auto reading = read();
    ASSERT_TRUE(reading);
    EXPECT_EQ(reading->state, Reading::State::valid);
    EXPECT_LT(norm(reading->sample.position - position), 1e-4);
    EXPECT_TRUE(reading->sample.is_down(0) && !reading->sample.is_down(1) && reading->sample.is_down(3));
    EXPECT_TRUE(is_valid(reading->sample));
    EXPECT_EQ(reading->taken, falcon_.now);
  }
}

TEST_F(FalconDevice, OneFrameGoesOutPerTick) {
  const std::size_t before = falcon_.frames.size();
  for (int tick = 0; tick < 100; ++tick) {
    ASSERT_TRUE(read());
    ASSERT_TRUE(write({0.5, 0, 0}));
  }
  EXPECT_EQ(falcon_.frames.size() - before, 101u);
}

TEST_F(FalconDevice, TheForceThatWasWrittenIsExerted) {
  for (const Vec3& position : {Vec3{}, Vec3{0.03, -0.02, 0.01}}) {
    move_to(position);
    ASSERT_TRUE(read_fresh());
    for (const Vec3& force : {Vec3{3, 0, 0}, Vec3{0, 3, 0}, Vec3{0, 0, -3}, Vec3{1, -2, 0.5}}) {
      ASSERT_TRUE(write(force));
      EXPECT_LT(norm(exerted(position) - force), 0.02) << force.x << ' ' << force.y << ' ' << force.z;
    }
  }
  ASSERT_TRUE(write({}));
  EXPECT_TRUE(falcon_.is_at_rest());
}

TEST_F(FalconDevice, NoForceBeforeHoming) {
  for (const unsigned homed : {0u, 1u, 6u}) {
    falcon_.reply.homed = static_cast<std::uint8_t>(homed);
    EXPECT_EQ(read_fresh()->state, Reading::State::not_homed);
    const auto refused = write({1, 0, 0});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::state);
    EXPECT_STREQ(refused.error().rule, "R-DEV-6");
    EXPECT_TRUE(falcon_.is_at_rest());
    EXPECT_TRUE(write({}));
  }
  falcon_.reply.homed = kAllHomed;
  ASSERT_TRUE(read_fresh());
  EXPECT_TRUE(write({1, 0, 0}));
  EXPECT_FALSE(falcon_.is_at_rest());
}

TEST_F(FalconDevice, NoForceOnceHomingIsLost) {
  ASSERT_TRUE(read());
  ASSERT_TRUE(write({1, 0, 0}));
  falcon_.reply.homed = 3;
  EXPECT_EQ(read_fresh()->state, Reading::State::not_homed);
  EXPECT_FALSE(write({1, 0, 0}));
  EXPECT_TRUE(falcon_.is_at_rest());
}

TEST_F(FalconDevice, TheLightReportsItsState) {
  falcon_.reply.homed = 0;
  static_cast<void>(read_fresh());
  EXPECT_EQ(falcon_.light(), 8u);
  falcon_.reply.homed = kAllHomed;
  static_cast<void>(read_fresh());
  EXPECT_EQ(falcon_.light(), 2u);
  falcon_.reply.counts = {3000, 3000, 3000};
  static_cast<void>(read_fresh());
  EXPECT_EQ(falcon_.light(), 4u);
}

TEST_F(FalconDevice, OutOfReachTheLastPoseStays) {
  move_to({0.01, 0.02, 0.03});
  const auto before = read();
  falcon_.reply.counts = {3000, 3000, 3000};
  const auto after = read();
  ASSERT_TRUE(after);
  EXPECT_EQ(after->state, Reading::State::out_of_reach);
  EXPECT_EQ(after->sample.position, before->sample.position);
  ASSERT_TRUE(write({0, 1, 0}));  // a force on its way to zero is still one there
  EXPECT_LT(norm(exerted(before->sample.position) - Vec3{0, 1, 0}), 0.02);
}

TEST_F(FalconDevice, ADeadlineIsKeptAndSilenceEndsTheUse) {
  ASSERT_TRUE(read());
  ASSERT_TRUE(write({1, 0, 0}));
  ASSERT_TRUE(read());
  falcon_.is_deaf = true;
  const Time silent = falcon_.now;
  for (Result<Reading> reading = read(); falcon_.now - silent < kAnswerTime; reading = read()) {
    const Time before = falcon_.now;
    ASSERT_TRUE(reading);
    EXPECT_EQ(reading->taken, silent);
    EXPECT_LE(before - silent, kAnswerTime);
  }
  expect_ended(read(), "R-DEV-4");
}

TEST_F(FalconDevice, WhatGotLostIsAskedForAgain) {
  ASSERT_TRUE(read());
  falcon_.spoil = [left = 3](std::vector<std::uint8_t> bytes) mutable {
    return left-- > 0 ? std::vector<std::uint8_t>{} : bytes;
  };
  const Time begin = falcon_.now;
  const auto reading = read(kAnswerTime);
  ASSERT_TRUE(reading);
  EXPECT_GT(reading->taken, begin);
  // And no answer lags behind afterwards.
  for (int tick = 1; tick < 10; ++tick) {
    ASSERT_TRUE(write({}));
    falcon_.reply.buttons = static_cast<std::uint8_t>(tick);
    EXPECT_EQ(read_fresh()->sample.buttons, tick);
  }
}

TEST_F(FalconDevice, AFewBrokenFramesAreAskedForAgain) {
  for (int broken = 1; broken <= 3; ++broken) {
    falcon_.spoil = [left = broken](std::vector<std::uint8_t> bytes) mutable {
      if (left-- > 0) bytes[5] = 'z';
      return bytes;
    };
    EXPECT_TRUE(read(kAnswerTime)) << broken;
  }
}

TEST_F(FalconDevice, NothingButBrokenFramesEndTheUse) {
  ASSERT_TRUE(read());
  ASSERT_TRUE(write({1, 0, 0}));
  falcon_.answer.clear();
  falcon_.spoil = [](std::vector<std::uint8_t> bytes) {
    bytes[5] = 'z';
    return bytes;
  };
  expect_ended(read(kAnswerTime), "R-DEV-5");
}

TEST_F(FalconDevice, EveryFailedTransferEndsInZeroForce) {
  for (const UsbStatus failure : {UsbStatus::gone, UsbStatus::failed, UsbStatus::denied}) {
    for (std::uint64_t number = 0; number < 12; ++number) {
      FakeFalcon falcon;
      auto device = FalconBackend(std::make_unique<FakeBus>(falcon)).open("0", {});
      ASSERT_TRUE(device);
      falcon.failure = failure;
      falcon.fails_at = number;
      Result<void> done;
      for (int tick = 0; tick < 10 && done; ++tick) {
        if (auto reading = (*device)->read(falcon.now + 5 * kMillisecond); !reading) done = tl::unexpected(reading.error());
        else done = (*device)->write(guarded({2, 0, 0}));
      }
      ASSERT_FALSE(done) << number;
      EXPECT_STREQ(done.error().rule, "R-DEV-4");
      EXPECT_EQ(done.error().code, Errc::io);
      const auto& last = falcon.frames.back();
      EXPECT_EQ(std::string(last.begin() + 1, last.begin() + 13), "AAAAAAAAAAAA") << number;
    }
  }
}

TEST_F(FalconDevice, HaltingStopsUntilTheNextWrite) {
  ASSERT_TRUE(read());
  ASSERT_TRUE(write({2, 0, 0}));
  EXPECT_FALSE(falcon_.is_at_rest());
  std::thread([this] { device_->halt(); }).join();
  EXPECT_TRUE(falcon_.is_at_rest());
  ASSERT_TRUE(read_fresh());
  EXPECT_TRUE(falcon_.is_at_rest());
  ASSERT_TRUE(write({2, 0, 0}));
  EXPECT_FALSE(falcon_.is_at_rest());
}

TEST_F(FalconDevice, HaltingWhileAnotherThreadReadsStopsAtOnce) {
  ASSERT_TRUE(read());
  ASSERT_TRUE(write({2, 0, 0}));
  bool stopped = false;
  falcon_.while_reading = [&] {
    std::thread([&] { device_->halt(); }).join();
    stopped = falcon_.is_at_rest();
  };
  ASSERT_TRUE(read());
  EXPECT_TRUE(stopped);
  EXPECT_TRUE(falcon_.is_at_rest());
}

TEST_F(FalconDevice, HaltingAheadOfTheFrameOfAWriteStopsToo) {
  ASSERT_TRUE(read());
  bool was_at_rest = false;
  falcon_.ahead_of_writing = [&] {
    std::thread([&] { device_->halt(); }).join();
    was_at_rest = falcon_.is_at_rest();
  };
  ASSERT_TRUE(write({2, 0, 0}));
  EXPECT_TRUE(was_at_rest);
  EXPECT_TRUE(falcon_.is_at_rest());  // though its own frame came later
  ASSERT_TRUE(read());
  EXPECT_TRUE(falcon_.is_at_rest());
  ASSERT_TRUE(write({2, 0, 0}));
  EXPECT_FALSE(falcon_.is_at_rest());
}

TEST_F(FalconDevice, HaltingMeetsReadsAndWritesAnywhere) {
  ASSERT_TRUE(read());
  const GuardedForce force = guarded({2, 0, 0});
  for (int round = 0; round < 50; ++round) {
    std::thread loop([&] {
      for (int tick = 0; tick < 20; ++tick) {
        static_cast<void>(device_->read(0));
        static_cast<void>(device_->write(force));
      }
    });
    for (int i = 0; i < 5; ++i) device_->halt();
    loop.join();
    device_->halt();
    EXPECT_TRUE(falcon_.is_at_rest());
    EXPECT_TRUE(device_->read(0));
  }
}

TEST_F(FalconDevice, ClosingLeavesNoForceAndNoInterface) {
  ASSERT_TRUE(read());
  ASSERT_TRUE(write({2, 0, 0}));
  device_.reset();
  EXPECT_TRUE(falcon_.is_at_rest());
  EXPECT_EQ(falcon_.ports, 0);
}

TEST_F(FalconDevice, NoCallAllocates) {
  falcon_.frames.reserve(1000);
  ASSERT_TRUE(read());
  const GuardedForce force = guarded({1, 1, 1});
  falcon_.is_deaf = true;
  falcon_.runs = false;
  const std::uint64_t before = testing::allocated_bytes();
  static_cast<void>(device_->read(falcon_.now));
  const std::uint64_t reading = testing::allocated_bytes();
  static_cast<void>(device_->write(force));
  device_->halt();
  EXPECT_LE(reading - before, 16u);  // the copy that the fake makes of each frame
  EXPECT_EQ(testing::allocated_bytes() - reading, 32u);
}

TEST(FalconBackend, SaysWhatIsThereAndWhatIsMissing) {
  FakeFalcon falcon;
  auto bus = std::make_unique<FakeBus>(falcon);
  FakeBus& usb = *bus;
  const FalconBackend backend(std::move(bus));
  EXPECT_STREQ(backend.name(), "falcon");
  ASSERT_EQ(backend.list().devices.size(), 1u);
  EXPECT_EQ(backend.list().devices[0].name, "falcon:0");
  EXPECT_EQ(backend.list().missing.size(), 1u);
  usb.refusal = UsbStatus::denied;
  ASSERT_EQ(backend.list().missing.size(), 2u);
  EXPECT_NE(backend.list().missing[0].find(kUdevRule), std::string::npos);
  usb.starts = false;
  EXPECT_TRUE(backend.list().devices.empty());
  EXPECT_EQ(backend.list().missing, std::vector<std::string>{"no USB here"});
  EXPECT_EQ(falcon.transfers + falcon.frames.size() + falcon.settings.size(), 0u);
}

TEST(FalconBackend, SaysWhyADeviceIsNotOpened) {
  FakeFalcon falcon;
  auto bus = std::make_unique<FakeBus>(falcon);
  FakeBus& usb = *bus;
  const FalconBackend backend(std::move(bus));
  const auto reported = [&](const char* which) { return to_string(backend.open(which, {}).error()); };
  for (const char* which : {"1", "x", "-1", "0x", "99999999999999999999999"})
    EXPECT_EQ(reported(which).find("falcon:" + std::string(which) + ": R-DEV-1"), 0u) << reported(which);
  usb.refusal = UsbStatus::denied;
  EXPECT_NE(reported("").find("R-DEV-2"), std::string::npos);
  EXPECT_NE(reported("").find(
                R"(70-falcon.rules, then unplug the Falcon and plug it in again: SUBSYSTEM=="usb", ATTR{idVendor}=="0403")"),
            std::string::npos)
      << reported("");
  EXPECT_NE(reported("").find(R"(TAG+="uaccess")"), std::string::npos);
  usb.refusal = UsbStatus::busy;
  EXPECT_NE(reported("").find("R-DEV-2"), std::string::npos);
  EXPECT_NE(reported("").find("end the program that has the Falcon"), std::string::npos);
  usb.refusal = UsbStatus::failed;
  EXPECT_NE(reported("").find("R-DEV-4"), std::string::npos);
  usb.refusal = UsbStatus::done;
  falcon.runs = false;
  EXPECT_NE(reported("").find("R-DEV-3"), std::string::npos);
  EXPECT_EQ(falcon.ports, 0);
}

TEST(FalconBackend, TheRealBusIsLookedAtWithoutHarm) {
  const FalconBackend backend;
  const Backend::Listing listing = backend.list();
  if (!listing.devices.empty()) GTEST_SKIP() << "a Falcon is connected";
  const auto device = backend.open("", {});
  ASSERT_FALSE(device);
  EXPECT_TRUE(device.error().error.rule == std::string("R-DEV-1") || device.error().error.rule == std::string("R-DEV-4"));
}

}  // namespace
}  // namespace tactus::device::falcon
