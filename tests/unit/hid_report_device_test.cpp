// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/hid/hid_device.h>

#include <gtest/gtest.h>

#include "tests/property/allocated.h"
#include "tests/unit/hid_desk.h"

namespace tactus::device::hid {
namespace {

using testing::Bytes;
using testing::listing;

class ReportDevice : public testing::OnDesk {
 protected:
  std::unique_ptr<Device> opened_by_path(const Bytes& descriptor) {
    desk_.listings = {listing(descriptor)};
    desk_.told = descriptor;
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

}  // namespace
}  // namespace tactus::device::hid
