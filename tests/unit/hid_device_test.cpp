// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/hid/hid_device.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tactus/device/force_guard.h>
#include "tests/property/allocated.h"
#include "tests/unit/hid_desk.h"

namespace tactus::device::hid {
namespace {

using testing::Bytes;
using testing::listing;
using HidDevice = testing::OnDesk;

Bytes report(std::uint8_t id, std::initializer_list<int> values) {
  Bytes out{id};
  for (const int value : values) {
    out.push_back(static_cast<std::uint8_t>(value & 0xff));
    out.push_back(static_cast<std::uint8_t>(value >> 8 & 0xff));
  }
  return out;
}

TEST_F(HidDevice, CapabilitiesComeFromTheDescriptor) {
  const auto device = opened(testing::older_mouse());
  const Capabilities& about = device->capabilities();
  EXPECT_EQ(about.name, "hid:0");
  EXPECT_EQ(about.model, "SpaceMouse");
  EXPECT_EQ(about.serial, "S1");
  EXPECT_EQ(about.buttons, 2u);
  EXPECT_EQ(about.force_axes, 0u);
  EXPECT_FALSE(about.paces);
  EXPECT_TRUE(about.senses.orientation && about.senses.buttons && !about.senses.velocity);
  for (const double reach : {about.high.x, about.high.y, about.high.z, -about.low.x, -about.low.y, -about.low.z})
    EXPECT_NEAR(reach, 1400e-4 * 0.01, 1e-12);  // 1400 times 10^-4 cm
  EXPECT_FALSE(ForceGuard::create(about, {}));
}

TEST_F(HidDevice, ShiftsAndTurnsOfAMouseAreRead) {
  const auto device = opened(testing::older_mouse());
  EXPECT_EQ(after(*device, {}).sample.position, Vec3{});
  const Reading reading = after(*device, {report(1, {350, -175, 70}), report(2, {0, 0, 350}), {3, 2, 0}, {23, 100}});
  EXPECT_LT(norm(reading.sample.position - Vec3{1.4e-3, 0.7e-3, -0.28e-3}), 1e-12);
  EXPECT_NEAR(reading.sample.orientation.w, std::cos(kDefaultTurn / 2), 1e-12);
  EXPECT_NEAR(reading.sample.orientation.z, -std::sin(kDefaultTurn / 2), 1e-12);  // about an axis that points down
  EXPECT_TRUE(!reading.sample.is_down(0) && reading.sample.is_down(1));
  EXPECT_TRUE(is_valid(reading.sample));
  EXPECT_EQ(reading.state, Reading::State::valid);
}

TEST_F(HidDevice, WithoutNewsTheSampleHolds) {
  const auto device = opened(testing::newer_mouse());
  const Reading before = after(*device, {report(1, {1, 2, 3, 4, 5, 6}), {3, 1, 0}});
  desk_.now = 77;
  const Reading later = after(*device, {});
  EXPECT_EQ(later.sample.position, before.sample.position);
  EXPECT_EQ(later.sample.orientation, before.sample.orientation);
  EXPECT_EQ(later.sample.buttons, 1u);
  EXPECT_EQ(later.taken, 77);
  EXPECT_EQ(after(*device, {{3, 0, 0}}).sample.buttons, 0u);
  EXPECT_EQ(after(*device, {report(1, {9}), {1}, {}}).sample.position.y,
            before.sample.position.y);  // short: what is not there stays
}

TEST_F(HidDevice, TheNewestReportCounts) {
  const auto device = opened(testing::newer_mouse());
  EXPECT_NEAR(after(*device, {report(1, {350, 0, 0, 0, 0, 0}), report(1, {-350, 0, 0, 0, 0, 0})}).sample.position.x, -1.4e-3,
              1e-12);
  EXPECT_NEAR(after(*device, {report(1, {32767, 0, 0, 0, 0, 0})}).sample.position.x, 1.4e-3, 1e-12);  // beyond its range
}

TEST_F(HidDevice, OtherUnitsAndReportsWithoutIdsAreUnderstood) {
  const auto device = opened(testing::plain_controller());
  EXPECT_EQ(device->capabilities().buttons, 8u);
  EXPECT_NEAR(device->capabilities().high.x, 0.0254, 1e-12);
  const Reading reading = after(*device, {{255, 0, 255, 255, 127, 128, 0x81}});
  EXPECT_LT(norm(reading.sample.position - Vec3{0.0254, 0.0254, -0.0254}), 1e-12);
  EXPECT_NEAR(reading.sample.orientation.w, std::cos(std::numbers::pi / 4), 1e-4);  // a quarter turn
  EXPECT_NEAR(reading.sample.orientation.x, std::sin(std::numbers::pi / 4), 1e-4);
  EXPECT_EQ(reading.sample.buttons, 0x81u);
}

TEST_F(HidDevice, WithoutAUnitTheReachIsFixed) {
  Bytes bytes = testing::newer_mouse();
  const std::size_t unit = static_cast<std::size_t>(std::find(bytes.begin(), bytes.end(), 0x65) - bytes.begin());
  bytes[unit + 1] = 0;
  const auto device = opened(bytes);
  EXPECT_NEAR(device->capabilities().high.x, kDefaultReach, 1e-12);
  EXPECT_NEAR(after(*device, {report(1, {350, 0, 0, 0, 0, 0})}).sample.position.x, kDefaultReach, 1e-12);
}

TEST_F(HidDevice, UnpluggedItStaysGone) {
  const auto device = opened(testing::newer_mouse());
  desk_.is_gone = true;
  EXPECT_STREQ(device->read(0).error().rule, "R-DEV-4");
  desk_.is_gone = false;
  EXPECT_EQ(device->read(0).error().code, Errc::io);
}

TEST_F(HidDevice, ItTakesNoForceAndReadingAllocatesNothing) {
  const auto device = opened(testing::newer_mouse());
  Capabilities other;
  other.force_axes = 3;
  other.nominal_force = 1;
  EXPECT_STREQ(device->write(ForceGuard::create(other, {})->stop()).error().rule, "R-DEV-6");
  device->halt();
  const std::uint64_t before = testing::allocated_bytes();
  EXPECT_TRUE(device->read(0));
  EXPECT_EQ(testing::allocated_bytes(), before);
}

TEST_F(HidDevice, ListsWhatItServesAndSaysWhatIsMissing) {
  desk_.listings = {listing({}), listing(testing::gamepad()), listing(testing::older_mouse()), listing(testing::newer_mouse()),
                    listing(testing::gamepad())};
  desk_.listings[3].may_open = desk_.listings[4].may_open = false;
  const HidBackend backend(std::make_unique<testing::FakeBus>(desk_));
  const Backend::Listing found = backend.list();
  ASSERT_EQ(found.devices.size(), 3u);
  EXPECT_EQ(found.devices[1].name, "hid:1");
  EXPECT_FALSE(found.devices[1].report_descriptor);
  EXPECT_EQ(found.devices[2].name, "hid:/dev/hidraw3") << "no controller, and may be opened";
  EXPECT_EQ(found.devices[2].report_descriptor, testing::gamepad());
  ASSERT_EQ(found.missing.size(), 1u);
  EXPECT_EQ(found.missing[0],
            "hid:1: you may not open it. Write this line to /etc/udev/rules.d/70-hid.rules, then unplug the device and plug "
            "it in again: KERNEL==\"hidraw*\", KERNELS==\"*:256F:C62E.*\", TAG+=\"uaccess\"");
}

TEST_F(HidDevice, SaysWhyItIsNotOpened) {
  desk_.listings = {listing(testing::newer_mouse())};
  const HidBackend backend(std::make_unique<testing::FakeBus>(desk_));
  const auto told = [&](const char* which) { return to_string(backend.open(which, {}).error()); };
  for (const char* which : {"1", "x", "-1", "0 ", "/dev/hidraw4", "/"})
    EXPECT_EQ(told(which).find("hid:" + std::string(which) + ": R-DEV-1"), 0u) << told(which);
  desk_.refusal = RawRefusal::denied;
  EXPECT_NE(told("").find("hid:0: R-DEV-2"), std::string::npos);
  EXPECT_NE(told("").find("TAG+=\"uaccess\""), std::string::npos);
  desk_.refusal = RawRefusal::gone;
  EXPECT_NE(told("0").find("/dev/hidraw3 cannot be opened: R-DEV-4"), std::string::npos);
  desk_.refusal.reset();
  EXPECT_NE(told("0").find("R-DEV-5"), std::string::npos);  // it tells no descriptor
}

TEST(HidBackend, TheRealDevicesAreLookedAtWithoutHarm) {
  const HidBackend backend;
  const Backend::Listing listing = backend.list();
  const auto is_controller = [](const Capabilities& can) { return !can.report_descriptor; };
  if (std::ranges::any_of(listing.devices, is_controller)) GTEST_SKIP() << "a controller is connected";
  EXPECT_STREQ(backend.open("", {}).error().error.rule, "R-DEV-1");
}

}  // namespace
}  // namespace tactus::device::hid
