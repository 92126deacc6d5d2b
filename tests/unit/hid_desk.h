// SPDX-License-Identifier: Apache-2.0
/// A desk with HID devices that a test moves.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tactus/device/hid/hid_device.h>
#include "tests/unit/hid_fixture.h"

namespace tactus::testing {

using device::Device;
using device::Reading;
using device::Time;
using device::hid::HidBackend;
using device::hid::RawBus;
using device::hid::RawListing;
using device::hid::RawPort;
using device::hid::RawRefusal;

/// What the devices are; outlives the ports.
struct FakeDesk {
  std::vector<RawListing> listings;
  Bytes reported;  // by the open device
  std::optional<RawRefusal> refusal;
  std::deque<Bytes> reports;
  bool is_gone = false;
  Time now = 5;
};

class FakePort final : public RawPort {
 public:
  explicit FakePort(FakeDesk& desk) : desk_(&desk) {}
  const Bytes& descriptor() const noexcept override { return desk_->reported; }
  std::optional<std::size_t> read(std::span<std::uint8_t> report) noexcept override {
    if (desk_->is_gone) return std::nullopt;
    if (desk_->reports.empty()) return 0;
    const Bytes next = desk_->reports.front();
    desk_->reports.pop_front();
    const std::size_t size = std::min(next.size(), report.size());
    std::copy_n(next.begin(), size, report.begin());
    return size;
  }
  Time now() const noexcept override { return desk_->now; }

 private:
  FakeDesk* desk_;
};

class FakeBus final : public RawBus {
 public:
  explicit FakeBus(FakeDesk& desk) : desk_(&desk) {}
  tl::expected<std::vector<RawListing>, std::string> list() const override { return desk_->listings; }
  tl::expected<std::unique_ptr<RawPort>, RawRefusal> open(const std::string&) const override {
    if (desk_->refusal) return tl::unexpected(*desk_->refusal);
    return std::make_unique<FakePort>(*desk_);
  }

 private:
  FakeDesk* desk_;
};

inline RawListing listing(const Bytes& descriptor) {
  return {"/dev/hidraw3", "SpaceMouse", "S1", 0x256f, 0xc62e, true, descriptor};
}

class OnDesk : public ::testing::Test {
 protected:
  std::unique_ptr<Device> opened(const Bytes& descriptor) {
    desk_.listings = {listing({0x05, 0x01}), listing(gamepad()), listing(descriptor)};
    desk_.reported = descriptor;
    auto device = HidBackend(std::make_unique<FakeBus>(desk_)).open("", {});
    if (!device) ADD_FAILURE() << to_string(device.error());
    return *std::move(device);
  }
  Reading after(Device& device, std::initializer_list<Bytes> reports) {
    desk_.reports.assign(reports);
    return device.read(0).value();
  }
  FakeDesk desk_;
};

}  // namespace tactus::testing
