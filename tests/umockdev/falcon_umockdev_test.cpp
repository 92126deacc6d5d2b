// SPDX-License-Identifier: Apache-2.0
/// A Falcon of umockdev, through libusb.
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <sys/wait.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <list>
#include <thread>

#include <tactus/device/falcon/falcon_device.h>
#include <tactus/device/falcon/falcon_kinematics.h>
#include <tactus/device/force_guard.h>
#include "tests/umockdev/testbed.h"
#include "tests/unit/falcon_fixture.h"

namespace tactus::device::falcon {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Clock = std::chrono::steady_clock;

const Bytes kDescriptors{18, 1, 0,    2, 0,  0,    0,    64,   3,  4, 0x48, 0xcb, 0, 4,
                         0,  0, 3,    1,                            // the device: 0403:cb48, serial is text 3
                         9,  2, 32,   0, 1,  1,    0,    0x80, 50,  // its configuration
                         9,  4, 0,    0, 2,  0xff, 0xff, 0xff, 0,   // its interface
                         7,  5, 0x81, 2, 64, 0,    0,    7,    5,  2, 2,    64,   0, 0};  // bulk in, bulk out

/// A request that was handed over and did not come back yet.
struct Urb {
  UMockdevIoctlClient* client;
  UMockdevIoctlData* data;
  UMockdevIoctlData* buffer;
  Clock::time_point begin;
  bool is_dropped = false;
  usbdevfs_urb& head() const { return *reinterpret_cast<usbdevfs_urb*>(data->data); }
};

class FalconUmockdev : public testing::Testbed {
 protected:
  void plug_falcon() {
    plug(
        "P: /devices/pci0000:00/0000:00:14.0/usb1/1-1\nN: bus/usb/001/002\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\n"
        "E: DEVNAME=/dev/bus/usb/001/002\nE: BUSNUM=001\nE: DEVNUM=002\nA: busnum=1\\n\nA: devnum=2\\n\nA: "
        "bConfigurationValue=1\\n\n"
        "A: speed=12\\n\nH: descriptors=" +
            testing::hex(kDescriptors) + "\n\n",
        "/dev/bus/usb/001/002");
  }
  void TearDown() override {
    Testbed::TearDown();
    while (!urbs_.empty()) forget(urbs_.begin());
  }

  bool answer_read(UMockdevIoctlClient*, UMockdevIoctlData*) override { return false; }
  bool answer_ioctl(UMockdevIoctlClient* client, gulong request, UMockdevIoctlData* argument) override {
    const std::scoped_lock lock(falcon_.mutex);
    int error = 0;
    switch (request) {
      case USBDEVFS_GET_CAPABILITIES:
      case USBDEVFS_RELEASEINTERFACE:
      case USBDEVFS_IOCTL:
        break;
      case USBDEVFS_CLAIMINTERFACE:
      case USBDEVFS_DISCONNECT_CLAIM:
        error = is_busy_ ? EBUSY : 0;
        break;
      case USBDEVFS_SUBMITURB:
        error = submit(client, argument);
        break;
      case USBDEVFS_DISCARDURB:
        error = discard(argument);
        break;
      case USBDEVFS_REAPURB:
      case USBDEVFS_REAPURBNDELAY:
        error = reap(client, argument);
        break;
      default:
        return false;
    }
    umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
    return true;
  }

  void forget(UMockdevIoctlClient* client) override {
    const std::scoped_lock lock(falcon_.mutex);
    for (auto urb = urbs_.begin(); urb != urbs_.end();) {
      const auto at = urb++;
      if (at->client == client) forget(at);
    }
  }

  testing::FakeFalcon falcon_;
  bool is_busy_ = false;
  bool is_gone_ = false;

 private:
  int submit(UMockdevIoctlClient* client, UMockdevIoctlData* argument) {
    if (is_gone_) return ENODEV;
    UMockdevIoctlData* data = umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_urb), nullptr);
    if (data == nullptr) return ENODEV;  // the process that asks was killed
    const auto& head = *reinterpret_cast<const usbdevfs_urb*>(data->data);
    UMockdevIoctlData* buffer =
        umockdev_ioctl_data_resolve(data, offsetof(usbdevfs_urb, buffer), static_cast<std::size_t>(head.buffer_length), nullptr);
    if (buffer == nullptr) {
      umockdev_ioctl_data_unref(data);
      return ENODEV;
    }
    urbs_.push_back({client, data, buffer, Clock::now()});
    return 0;
  }
  int discard(UMockdevIoctlData* argument) {
    gulong address = 0;
    std::copy_n(argument->data, sizeof address, reinterpret_cast<std::uint8_t*>(&address));
    for (Urb& urb : urbs_) {
      if (urb.data->client_addr != address) continue;
      urb.is_dropped = true;
      return 0;
    }
    return EINVAL;
  }
  int reap(UMockdevIoctlClient* client, UMockdevIoctlData* argument) {
    for (auto urb = urbs_.begin(); urb != urbs_.end(); ++urb) {
      if (urb->client != client || !is_done(*urb)) continue;
      UMockdevIoctlData* pointer = umockdev_ioctl_data_resolve(argument, 0, sizeof(void*), nullptr);
      if (pointer == nullptr) return ENODEV;
      umockdev_ioctl_data_set_ptr(pointer, 0, urb->data);
      umockdev_ioctl_data_unref(pointer);
      forget(urb);
      return 0;
    }
    return is_gone_ ? ENODEV : EAGAIN;
  }
  void forget(std::list<Urb>::iterator urb) {
    umockdev_ioctl_data_unref(urb->buffer);
    umockdev_ioctl_data_unref(urb->data);
    urbs_.erase(urb);
  }

  bool is_done(const Urb& urb) {
    usbdevfs_urb& head = urb.head();
    const std::span<std::uint8_t> buffer(urb.buffer->data, static_cast<std::size_t>(head.buffer_length));
    head.status = urb.is_dropped ? -ENOENT : is_gone_ ? -ESHUTDOWN : 0;
    head.actual_length = 0;
    if (head.status != 0) return true;
    if (head.type == USBDEVFS_URB_TYPE_CONTROL) head.actual_length = control(buffer);
    else if (head.endpoint == 0x02) head.actual_length = heard(buffer);
    else if (falcon_.answer.empty() && Clock::now() - urb.begin < std::chrono::milliseconds(1)) return false;
    else head.actual_length = answered(buffer);
    return true;
  }
  /// Eight bytes of request, then its data.
  int control(std::span<std::uint8_t> buffer) {
    if (buffer[0] == 0x40) {
      falcon_.settings.emplace_back(buffer[1], static_cast<std::uint16_t>(buffer[2] + 256 * buffer[3]));
      if (buffer[1] == 3) falcon_.baud = falcon_.settings.back().second;
      return 0;
    }
    const Bytes text = buffer[2] == 0 ? Bytes{4, 3, 9, 4} : Bytes{6, 3, 'F', 0, '9', 0};  // languages, or the serial number
    const std::size_t size = std::min(text.size(), buffer.size() - 8);
    std::copy_n(text.begin(), size, buffer.begin() + 8);
    return static_cast<int>(size);
  }
  int heard(std::span<const std::uint8_t> bytes) {
    falcon_.hear(bytes);
    return static_cast<int>(bytes.size());
  }
  int answered(std::span<std::uint8_t> buffer) {
    const std::size_t size = std::min(falcon_.answer.size(), buffer.size() - 2);
    buffer[0] = 1, buffer[1] = 0x60;
    std::copy_n(falcon_.answer.begin(), size, buffer.begin() + 2);
    falcon_.answer.erase(falcon_.answer.begin(), falcon_.answer.begin() + static_cast<std::ptrdiff_t>(size));
    return static_cast<int>(size) + 2;
  }

  std::list<Urb> urbs_;
};

Time soon() { return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count() + kAnswerTime; }

TEST_F(FalconUmockdev, AFalconIsFoundMovedRenderedToAndLost) {
  plug_falcon();
  const FalconBackend backend;
  const Backend::Listing found = backend.list();
  ASSERT_EQ(found.devices.size(), 1u);
  EXPECT_EQ(found.missing.size(), 1u) << "but for the firmware nothing is missing";
  auto opened = backend.open("0", {});
  ASSERT_TRUE(opened) << to_string(opened.error());
  Device& device = **opened;
  EXPECT_EQ(device.capabilities().serial, "F9");
  auto guard = ForceGuard::create(device.capabilities(), {0, 1e9, 10 * kMillisecond, false});
  for (int tick = 0; tick < 200; ++tick) {
    const auto reading = device.read(soon());
    ASSERT_TRUE(reading);
    ASSERT_EQ(reading->state, Reading::State::valid);
    ASSERT_TRUE(device.write(guard->pass({{1, 0, 0}, reading->taken}, *reading, reading->taken)));
  }
  {
    const std::scoped_lock lock(falcon_.mutex);
    EXPECT_FALSE(falcon_.is_at_rest());
  }
  device.halt();
  {
    const std::scoped_lock lock(falcon_.mutex);
    EXPECT_TRUE(falcon_.is_at_rest());
    is_gone_ = true;
  }
  EXPECT_STREQ(device.read(soon()).error().rule, "R-DEV-4");
}

/// Until the process is killed.
[[noreturn]] void push() {
  auto opened = FalconBackend().open("0", {});
  if (!opened) _exit(1);
  Device& device = **opened;
  auto guard = ForceGuard::create(device.capabilities(), {0, 1e9, 10 * kMillisecond, false});
  for (;;) {
    const auto reading = device.read(soon());
    if (!reading || !device.write(guard->pass({{1, 0, 0}, reading->taken}, *reading, reading->taken))) _exit(2);
  }
}

TEST_F(FalconUmockdev, AKilledProcessLetsGo) {
  plug_falcon();
  const pid_t client = fork();
  if (client == 0) push();
  const auto becomes = [&](bool is_at_rest) {
    for (const Clock::time_point begin = Clock::now(); Clock::now() - begin < std::chrono::seconds(10);) {
      std::this_thread::sleep_for(std::chrono::microseconds(200));
      const std::scoped_lock lock(falcon_.mutex);
      if (falcon_.is_at_rest() == is_at_rest) return true;
    }
    return false;
  };
  EXPECT_TRUE(becomes(false));
  const Clock::time_point end = Clock::now();
  kill(client, SIGKILL);
  waitpid(client, nullptr, 0);
  EXPECT_TRUE(becomes(true));
  RecordProperty("us_to_rest", std::to_string(std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - end).count()));
}

TEST_F(FalconUmockdev, AnotherThreadHaltsWhileOneReads) {
  plug_falcon();
  auto opened = FalconBackend().open("0", {});
  ASSERT_TRUE(opened) << to_string(opened.error());
  Device& device = **opened;
  std::thread halting([&] {
    for (int i = 0; i < 50; ++i) device.halt();
  });
  for (int tick = 0; tick < 50; ++tick) EXPECT_TRUE(device.read(soon()));
  halting.join();
  EXPECT_EQ(device.read(soon())->state, Reading::State::valid);
}

TEST_F(FalconUmockdev, ASilentFalconIsGivenUp) {
  plug_falcon();
  auto opened = FalconBackend().open("", {});
  ASSERT_TRUE(opened) << to_string(opened.error());
  {
    const std::scoped_lock lock(falcon_.mutex);
    falcon_.is_deaf = true;
  }
  EXPECT_STREQ((*opened)->read(soon()).error().rule, "R-DEV-4");
}

TEST_F(FalconUmockdev, ABusyFalconIsNotOpened) {
  plug_falcon();
  is_busy_ = true;
  const auto opened = FalconBackend().open("", {});
  ASSERT_FALSE(opened);
  EXPECT_STREQ(opened.error().error.rule, "R-DEV-2");
  EXPECT_NE(opened.error().remedy.find("End the program"), std::string::npos);
}

}  // namespace
}  // namespace tactus::device::falcon
