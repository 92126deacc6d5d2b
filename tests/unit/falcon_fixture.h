// SPDX-License-Identifier: Apache-2.0
/// A Falcon behind the USB interface, on a clock of its own: each transfer takes a millisecond. It can fail at any transfer.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tactus/device/falcon/falcon_frame.h>
#include <tactus/device/falcon/falcon_usb.h>

namespace tactus::testing {

using device::Time;
using device::falcon::Frame;
using device::falcon::Motors;
using device::falcon::Reply;
using device::falcon::UsbStatus;
using device::falcon::UsbTransfer;

inline std::vector<std::uint8_t> frame_of(const Reply& reply) {
  std::vector<std::uint8_t> out{'<'};
  for (const std::int16_t count : reply.counts)
    for (unsigned digit = 0; digit < 4; ++digit)
      out.push_back(
          static_cast<std::uint8_t>(0x41 + (static_cast<unsigned>(static_cast<std::uint16_t>(count)) >> 4 * digit & 0xfu)));
  out.push_back(static_cast<std::uint8_t>(0x41 + reply.buttons + 16 * reply.homed));
  out.push_back(0x41);
  out.push_back('>');
  return out;
}

/// What the Falcon is and what reached it; outlives the port.
struct FakeFalcon {
  bool runs = true;  // its firmware
  bool takes_firmware = true;
  bool is_deaf = false;  // answers nothing
  Reply reply{{0, 0, 0}, 0, 7};
  std::function<std::vector<std::uint8_t>(std::vector<std::uint8_t>)> spoil;  // of an answer
  std::optional<std::uint64_t> fails_at;  // number of the transfer that fails, and all after it
  UsbStatus failure = UsbStatus::gone;
  std::size_t most_bytes = 62;  // of an answer per transfer
  std::function<void()> while_reading, ahead_of_writing;

  mutable std::mutex mutex;  // of one transfer
  Time now = 1'000'000'000;
  std::uint64_t transfers = 0;
  std::vector<Frame> frames;  // that came, also those that failed
  std::vector<std::uint8_t> firmware;
  std::vector<std::pair<std::uint8_t, std::uint16_t>> settings;
  std::deque<std::uint8_t> answer;
  unsigned baud = 0;
  int ports = 0;  // open

  bool fails() { return fails_at && ++transfers > *fails_at; }
  int motor(std::size_t axis) const {
    int out = 0;
    for (std::size_t digit = 0; digit < 4; ++digit) out |= (frames.back()[1 + 4 * axis + digit] - 0x41) << 4 * digit;
    return static_cast<std::int16_t>(out);
  }
  bool is_at_rest() const { return frames.empty() || (motor(0) == 0 && motor(1) == 0 && motor(2) == 0); }
  unsigned light() const { return static_cast<unsigned>(frames.back()[13] - 0x41) & 14u; }

  void say(std::vector<std::uint8_t> bytes) {
    if (spoil) bytes = spoil(bytes);
    if (!is_deaf) answer.insert(answer.end(), bytes.begin(), bytes.end());
  }
  void hear(std::span<const std::uint8_t> bytes) {
    const std::vector<std::uint8_t> answered(bytes.begin(), bytes.end());
    if (baud == 2 && answered.size() == 16) {
      std::copy(answered.begin(), answered.end(), frames.emplace_back().begin());
      if (runs) say(frame_of(reply));
    } else if (baud == 0x4138 && answered == std::vector<std::uint8_t>{0x0a, 0x43, 0x0d}) {
      say({0x0a, 0x44, 0x2c, 0x0d});
    } else if (baud == 0x15) {
      if (answered.size() > 1) firmware.insert(firmware.end(), answered.begin(), answered.end());
      runs = takes_firmware;
      say(answered);
    }
  }
};

class FakePort final : public device::falcon::UsbPort {
 public:
  explicit FakePort(FakeFalcon& falcon) : falcon_(&falcon) { ++falcon.ports; }
  ~FakePort() override { --falcon_->ports; }

  UsbStatus control(std::uint8_t request, std::uint16_t value) noexcept override {
    const std::scoped_lock lock(falcon_->mutex);
    if (falcon_->fails()) return falcon_->failure;
    falcon_->settings.emplace_back(request, value);
    if (request == 3) falcon_->baud = value;
    return UsbStatus::done;
  }
  UsbTransfer write(std::span<const std::uint8_t> bytes) noexcept override {
    if (falcon_->ahead_of_writing) std::exchange(falcon_->ahead_of_writing, {})();
    const std::scoped_lock lock(falcon_->mutex);
    if (falcon_->fails()) {
      if (bytes.size() == 16) std::copy(bytes.begin(), bytes.end(), falcon_->frames.emplace_back().begin());
      return {falcon_->failure, 0};
    }
    falcon_->hear(bytes);
    return {UsbStatus::done, bytes.size()};
  }
  UsbTransfer read(std::span<std::uint8_t> bytes, Time) noexcept override {
    if (falcon_->while_reading) std::exchange(falcon_->while_reading, {})();
    const std::scoped_lock lock(falcon_->mutex);
    falcon_->now += device::kMillisecond;
    if (falcon_->fails()) return {falcon_->failure, 0};
    const std::size_t size = std::min({falcon_->answer.size(), falcon_->most_bytes, bytes.size() - 2});
    bytes[0] = 1, bytes[1] = '<';  // modem lines
    std::copy_n(falcon_->answer.begin(), size, bytes.begin() + 2);
    falcon_->answer.erase(falcon_->answer.begin(), falcon_->answer.begin() + static_cast<std::ptrdiff_t>(size));
    return {UsbStatus::done, size + 2};
  }
  Time now() const noexcept override {
    const std::scoped_lock lock(falcon_->mutex);
    return falcon_->now;
  }
  const std::string& serial() const noexcept override { return serial_; }

 private:
  FakeFalcon* falcon_;
  std::string serial_ = "F1";
};

class FakeBus final : public device::falcon::UsbBus {
 public:
  explicit FakeBus(FakeFalcon& falcon) : falcon_(&falcon) {}
  UsbStatus refusal = UsbStatus::done;
  bool starts = true;

  tl::expected<std::vector<bool>, std::string> list() const override {
    if (!starts) return tl::unexpected(std::string("no USB here"));
    return std::vector<bool>{refusal != UsbStatus::denied};
  }
  tl::expected<std::unique_ptr<device::falcon::UsbPort>, UsbStatus> open(std::size_t index,
                                                                         std::span<const std::uint8_t>) const override {
    if (index > 0) return tl::unexpected(UsbStatus::gone);
    if (refusal != UsbStatus::done) return tl::unexpected(refusal);
    return std::make_unique<FakePort>(*falcon_);
  }

 private:
  FakeFalcon* falcon_;
};

}  // namespace tactus::testing
