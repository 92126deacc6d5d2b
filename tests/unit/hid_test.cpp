// SPDX-License-Identifier: Apache-2.0
/// HID devices and what their reports say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>

#include <tactus/device/force_guard.h>
#include <tactus/device/hid/hid_device.h>
#include <tactus/device/hid/report_descriptor.h>
#include "tests/property/allocated.h"
#include "tests/unit/hid_desk.h"
#include "tests/unit/hid_fixture.h"

namespace tactus::device::hid {
namespace {

using testing::Bytes;
using testing::joined;
using testing::listing;

// ==== hid device ====

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
  EXPECT_FALSE(about.has_clock);
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
  const auto reported = [&](const char* which) { return to_string(backend.open(which, {}).error()); };
  for (const char* which : {"1", "x", "-1", "0 ", "/dev/hidraw4", "/"})
    EXPECT_EQ(reported(which).find("hid:" + std::string(which) + ": R-DEV-1"), 0u) << reported(which);
  desk_.refusal = RawRefusal::denied;
  EXPECT_NE(reported("").find("hid:0: R-DEV-2"), std::string::npos);
  EXPECT_NE(reported("").find("TAG+=\"uaccess\""), std::string::npos);
  desk_.refusal = RawRefusal::gone;
  EXPECT_NE(reported("0").find("/dev/hidraw3 cannot be opened: R-DEV-4"), std::string::npos);
  desk_.refusal.reset();
  EXPECT_NE(reported("0").find("R-DEV-5"), std::string::npos);  // it reports no descriptor
}

TEST(HidBackend, TheRealDevicesAreLookedAtWithoutHarm) {
  const HidBackend backend;
  const Backend::Listing listing = backend.list();
  const auto is_controller = [](const Capabilities& can) { return !can.report_descriptor; };
  if (std::ranges::any_of(listing.devices, is_controller)) GTEST_SKIP() << "a controller is connected";
  EXPECT_STREQ(backend.open("", {}).error().error.rule, "R-DEV-1");
}

// ==== hid report device ====

class ReportDevice : public testing::OnDesk {
 protected:
  std::unique_ptr<Device> opened_by_path(const Bytes& descriptor) {
    desk_.listings = {listing(descriptor)};
    desk_.reported = descriptor;
    return HidBackend(std::make_unique<testing::FakeBus>(desk_)).open("/dev/hidraw3", {}).value();
  }
};

TEST_F(ReportDevice, AControllerIsOneByItsPathToo) {
  const auto device = opened_by_path(testing::newer_mouse());
  EXPECT_FALSE(device->capabilities().report_descriptor);
  EXPECT_EQ(device->reports(), nullptr);
  EXPECT_EQ(device->capabilities().name, "hid:/dev/hidraw3");
}

TEST_F(ReportDevice, EveryReportOfAnotherDeviceIsHandedOnOnce) {
  const auto device = opened_by_path(testing::gamepad());
  EXPECT_EQ(device->capabilities().report_descriptor, testing::gamepad());
  EXPECT_EQ(device->capabilities().force_axes, 0u);
  after(*device, {{1, 2, 3}, {9}});
  const DeviceReports first{{3, 1}, {1, 2, 3, 9}};
  EXPECT_EQ(*device->reports(), first);
  EXPECT_TRUE(device->read(0));
  EXPECT_EQ(*device->reports(), DeviceReports{});
}

TEST_F(ReportDevice, WhatFindsNoRoomComesWithTheNextTick) {
  const auto device = opened_by_path(testing::gamepad());
  for (const std::size_t size : {std::size_t{1}, std::size_t{64}, std::size_t{1000}, std::size_t{4097}}) {
    Bytes all, heard;
    for (std::uint8_t i = 0; i < 200; ++i) {
      desk_.reports.emplace_back(size, i);
      all.push_back(i);
    }
    while (heard.size() < all.size()) {
      ASSERT_TRUE(device->read(0));
      const DeviceReports& reports = *device->reports();
      ASSERT_TRUE(is_valid(reports));
      ASSERT_LE(reports.sizes.size(), kMostReports);
      ASSERT_LE(reports.bytes.size(), kMostReportBytes);
      ASSERT_FALSE(reports.sizes.empty());
      for (std::size_t at = 0; at < reports.bytes.size(); at += size) heard.push_back(reports.bytes[at]);
    }
    EXPECT_EQ(heard, all) << size << " bytes each";
  }
}

TEST_F(ReportDevice, WhatCameBeforeItWasUnpluggedIsNotLost) {
  class Ending final : public RawPort {
   public:
    const Bytes& descriptor() const noexcept override { return none_; }
    std::optional<std::size_t> read(std::span<std::uint8_t> report) noexcept override {
      if (left_-- <= 0) return std::nullopt;
      report[0] = 7;
      return 1;
    }
    Time now() const noexcept override { return 0; }

   private:
    Bytes none_;
    int left_ = 3;
  };
  const auto device = make_report_device(std::make_unique<Ending>(), listing(testing::gamepad()));
  ASSERT_TRUE(device->read(0));
  EXPECT_EQ(device->reports()->sizes.size(), 3u);
  EXPECT_STREQ(device->read(0).error().rule, "R-DEV-4");
  EXPECT_STREQ(device->read(0).error().rule, "R-DEV-4") << "it stays gone";
}

TEST_F(ReportDevice, ItTakesNoForceAndReadingAllocatesNothing) {
  const auto device = opened_by_path(testing::gamepad());
  device->halt();
  const std::uint64_t before = testing::allocated_bytes();
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(device->read(0));
  EXPECT_EQ(testing::allocated_bytes(), before);
  EXPECT_EQ(device->capabilities().force_axes, 0u);
}

// ==== report descriptor ====

void expect_broken(const Bytes& bytes, const char* what) {
  const auto fields = parse_report_descriptor(bytes);
  ASSERT_FALSE(fields) << what;
  EXPECT_EQ(fields.error().code, Errc::malformed) << what;
  EXPECT_STREQ(fields.error().rule, "R-DEV-5") << what;
  EXPECT_LE(fields.error().bit_offset, 8 * bytes.size()) << what;
}

TEST(ReportDescriptor, AnOlderMouseHasThreeReports) {
  const auto fields = parse_report_descriptor(testing::older_mouse());
  ASSERT_TRUE(fields);
  ASSERT_EQ(fields->size(), 8u);
  for (std::uint32_t axis = 0; axis < 6; ++axis) {
    const auto report = static_cast<std::uint8_t>(axis < 3 ? 1 : 2);
    EXPECT_EQ((*fields)[axis],
              (Field{kAxisX + axis, kMultiAxisController, report, 16 * (axis % 3), 16, -350, 350, -1400, 1400, 0x11, -4}))
        << axis;
  }
  for (std::uint32_t button = 0; button < 2; ++button)
    EXPECT_EQ((*fields)[6 + button], (Field{kButtons + 1 + button, kMultiAxisController, 3, button, 1, 0, 1, 0, 1, 0x11, -4}))
        << button;
}

TEST(ReportDescriptor, ANewerMouseHasAllAxesInOne) {
  const auto fields = parse_report_descriptor(testing::newer_mouse());
  ASSERT_TRUE(fields);
  ASSERT_EQ(fields->size(), 8u);
  for (std::uint32_t axis = 0; axis < 6; ++axis) {
    EXPECT_EQ((*fields)[axis].usage, kAxisX + axis);
    EXPECT_EQ((*fields)[axis].report, 1);
    EXPECT_EQ((*fields)[axis].bit, 16 * axis);
  }
}

TEST(ReportDescriptor, LimitsArePlainWhereTheLowerOneIs) {
  const auto fields = parse_report_descriptor(testing::plain_controller());
  ASSERT_TRUE(fields);
  ASSERT_EQ(fields->size(), 14u);
  EXPECT_EQ((*fields)[0], (Field{kAxisX, kMultiAxisController, 0, 0, 8, 0, 255, 0, 2, 0x13, 0}));
  EXPECT_EQ((*fields)[3], (Field{kAxisX + 3, kMultiAxisController, 0, 24, 8, 0, 255, -90, 90, 0x14, 0}));
  EXPECT_EQ((*fields)[13].usage, kButtons + 8);
  EXPECT_EQ((*fields)[13].bit, 55u);
}

TEST(ReportDescriptor, StatesAreSavedAndPagesStandInUsages) {
  const auto fields =
      parse_report_descriptor(joined({{0x15, 0x81, 0x25, 0x7f, 0x75, 0x08, 0x95, 0x01},
                                      {0xa4, 0x75, 0x04, 0xb4},              // 4 bits, and back to 8
                                      {0xfe, 0x02, 0x33, 0x01, 0x02},        // a long item
                                      {0x0b, 0x30, 0x00, 0x01, 0x00},        // usage X with its page
                                      {0x81, 0x02, 0x05, 0x02, 0x09, 0x31},  // not Y: another page
                                      {0x81, 0x02, 0x09, 0x32, 0x05, 0x01},  // Z: the page comes later, but counts
                                      {0x81, 0x02}}));
  ASSERT_TRUE(fields);
  ASSERT_EQ(fields->size(), 2u);
  EXPECT_EQ((*fields)[0], (Field{kAxisX, 0, 0, 0, 8, -127, 127, -127, 127, 0, 0}));
  EXPECT_EQ((*fields)[1].usage, kAxisX + 2);
  EXPECT_EQ((*fields)[1].bit, 16u);
}

TEST(ReportDescriptor, ConstantsArraysAndOtherUsagesArePassedOver) {
  const auto only = [](const Bytes& input, const Bytes& usages) {
    const auto fields =
        parse_report_descriptor(joined({testing::kDesktop, {0x15, 0x00, 0x25, 0x7f, 0x75, 0x08, 0x95, 0x02}, usages, input}));
    return fields ? fields->size() : 99;
  };
  EXPECT_EQ(only({0x81, 0x02}, testing::kXyz), 2u);  // no more than are counted
  EXPECT_EQ(only({0x81, 0x03}, testing::kXyz), 0u);
  EXPECT_EQ(only({0x81, 0x00}, testing::kXyz), 0u);
  EXPECT_EQ(only({0x91, 0x02}, testing::kXyz), 0u);
  EXPECT_EQ(only({0xb1, 0x02}, testing::kXyz), 0u);
  EXPECT_EQ(only({0x81, 0x02}, {0x09, 0x38}), 0u);  // a wheel
  EXPECT_EQ(only({0x81, 0x02}, {0x09, 0x30}), 1u);  // what the second one is, is not stated
  EXPECT_EQ(only({0x81, 0x02}, {}), 0u);
}

TEST(ReportDescriptor, WhatIsOutOfOrderIsRefused) {
  expect_broken({0x26, 0x01}, "data cut off");
  expect_broken({0xfe, 0x02, 0x00, 0x01}, "a long item cut off");
  expect_broken({0xfe, 0x02}, "the head of a long item cut off");
  expect_broken({0xc0}, "an end without a beginning");
  expect_broken({0xa1, 0x01}, "a beginning without an end");
  expect_broken({0xb4}, "a state that was not saved");
  expect_broken({0x85, 0x00}, "report 0");
  expect_broken({0x86, 0x00, 0x01}, "report 256");
  expect_broken({0x75, 0x08, 0x95, 0x01, 0x81, 0x03, 0x85, 0x01}, "an id after a report without");
  expect_broken({0x29, 0x05}, "a range without a beginning");
  expect_broken({0x19, 0x05, 0x29, 0x04}, "a range backwards");
  expect_broken({0x05, 0x01, 0x09, 0x30, 0x75, 0x08, 0x95, 0x01, 0x81, 0x02}, "an axis without a range");
  expect_broken(
      joined({{0x15, 0x00, 0x25, 0x01, 0x56, 0x10, 0x00}, testing::kDesktop, {0x09, 0x30, 0x75, 0x08, 0x95, 0x01, 0x81, 0x02}}),
      "an exponent of 16");
}

TEST(ReportDescriptor, LimitsAreKept) {
  const Bytes cell{0x81, 0x03};
  EXPECT_TRUE(parse_report_descriptor({}));
  EXPECT_TRUE(parse_report_descriptor(Bytes(kMostDescriptor, 0x14)));
  expect_broken(Bytes(kMostDescriptor + 1, 0x14), "too long");
  EXPECT_TRUE(parse_report_descriptor(joined({{0x75, 0x08, 0x96, 0x00, 0x10}, cell})));
  expect_broken(joined({{0x75, 0x08, 0x96, 0x00, 0x10}, cell, {0x95, 0x01}, cell}), "a report of 4097 bytes");
  expect_broken(joined({{0x77, 0xff, 0xff, 0xff, 0xff, 0x97, 0xff, 0xff, 0xff, 0xff}, cell}), "2^64 bits");
  expect_broken(Bytes(65, 0xa4), "65 saved states");
  Bytes nested;
  for (int i = 0; i < 65; ++i) nested.insert(nested.end(), {0xa1, 0x00});
  expect_broken(nested, "65 collections");
  Bytes buttons{0x05, 0x09, 0x25, 0x01, 0x75, 0x01, 0x95, 0x20};
  for (int i = 0; i < 32; ++i) buttons.insert(buttons.end(), {0x19, 0x01, 0x29, 0x20, 0x81, 0x02});
  EXPECT_EQ(parse_report_descriptor(buttons)->size(), kMostFields);
  expect_broken(joined({buttons, {0x09, 0x01, 0x81, 0x02}}), "1025 fields");
}

TEST(ReportDescriptor, PrefixesAndBitFlipsDoNoHarm) {
  for (const Bytes& whole : {testing::older_mouse(), testing::newer_mouse(), testing::plain_controller()}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const Bytes prefix(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_EQ(parse_report_descriptor(prefix).has_value(), size < 5 && size % 2 == 0)
          << size;  // before the collection is opened
    }
    for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
      Bytes flipped = whole;
      flipped[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
      const auto fields = parse_report_descriptor(flipped);
      if (!fields) continue;
      for (const Field& field : *fields) EXPECT_LE(field.bit + field.size, kMostReport);
    }
  }
}

TEST(ReportDescriptor, ValuesAreCutOutOfReports) {
  Field field;
  field.report = 7;
  std::srand(3);
  for (int round = 0; round < 5000; ++round) {
    field.size = static_cast<std::uint8_t>(1 + std::rand() % 32);
    field.bit = static_cast<std::uint32_t>(std::rand() % 70);
    field.logical_low = std::rand() % 2 - 1;
    Bytes report(15);
    report[0] = 7;
    std::int64_t expected = 0;
    for (std::size_t bit = 8; bit < 8 * report.size(); ++bit) {
      if (std::rand() % 2 == 0) continue;
      report[bit / 8] = static_cast<std::uint8_t>(report[bit / 8] | 1u << bit % 8);
      const std::size_t offset = bit - 8 - field.bit;
      if (offset < field.size) expected |= std::int64_t{1} << offset;
    }
    if (field.logical_low < 0 && (expected >> (field.size - 1) & 1) != 0) expected -= std::int64_t{1} << field.size;
    ASSERT_EQ(value_in(report, field), expected) << +field.size << ' ' << field.bit;
    const std::size_t needed = 1 + (field.bit + field.size + 7) / 8;
    EXPECT_TRUE(value_in(std::span(report).first(needed), field));
    EXPECT_FALSE(value_in(std::span(report).first(needed - 1), field));
    report[0] = 8;
    EXPECT_FALSE(value_in(report, field));
  }
  EXPECT_FALSE(value_in({}, field));
}

}  // namespace
}  // namespace tactus::device::hid
