// SPDX-License-Identifier: Apache-2.0
/// A SpaceMouse of umockdev, through hidapi.
#include <linux/hidraw.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <deque>
#include <mutex>

#include <tactus/device/hid/hid_device.h>
#include "tests/umockdev/testbed.h"
#include "tests/unit/hid_fixture.h"

namespace tactus::device::hid {
namespace {

class HidUmockdev : public testing::Testbed {
 protected:
  void plug_mouse() {
    const std::string usb = "/devices/pci0000:00/0000:00:14.0/usb1/1-1", face = usb + "/1-1:1.0",
                      hid = face + "/0003:256F:C62E.0001";
    plug("P: " + usb +
             "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nA: idVendor=256f\nA: idProduct=c62e\nA: product=SpaceMouse Wireless\n" +
             "A: manufacturer=3Dconnexion\nA: serial=S7\nA: bcdDevice=0438\n\n" + "P: " + face +
             "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_interface\nA: bInterfaceNumber=00\n\n" + "P: " + hid +
             "\nE: SUBSYSTEM=hid\nE: HID_ID=0003:0000256F:0000C62E\nE: HID_NAME=SpaceMouse Wireless\nE: HID_UNIQ=S7\n" +
             "H: report_descriptor=" + testing::hex(descriptor_) + "\n\n" + "P: " + hid +
             "/hidraw/hidraw0\nN: hidraw0\nE: DEVNAME=/dev/hidraw0\nE: SUBSYSTEM=hidraw\nL: "
             "device=../../../0003:256F:C62E.0001\n\n",
         "/dev/hidraw0");
    make_readable();
  }
  void send(const testing::Bytes& report) {
    const std::scoped_lock lock(mutex_);
    reports_.push_back(report);
  }
  void unplug() {
    const std::scoped_lock lock(mutex_);
    is_gone_ = true;
  }

  bool answer_ioctl(UMockdevIoctlClient* client, gulong request, UMockdevIoctlData* argument) override {
    const int size = static_cast<int>(descriptor_.size());
    if (request != HIDIOCGRDESCSIZE && request != HIDIOCGRDESC) return false;
    UMockdevIoctlData* reported = umockdev_ioctl_data_resolve(
        argument, 0, request == HIDIOCGRDESC ? sizeof(hidraw_report_descriptor) : sizeof(int), nullptr);
    std::copy_n(reinterpret_cast<const std::uint8_t*>(&size), sizeof size, reported->data);
    if (request == HIDIOCGRDESC) std::copy(descriptor_.begin(), descriptor_.end(), reported->data + sizeof size);
    umockdev_ioctl_client_complete(client, 0, 0);
    umockdev_ioctl_data_unref(reported);
    return true;
  }
  bool answer_read(UMockdevIoctlClient* client, UMockdevIoctlData* buffer) override {
    const std::scoped_lock lock(mutex_);
    if (is_gone_ || reports_.empty()) {
      umockdev_ioctl_client_complete(client, -1, is_gone_ ? ENODEV : EAGAIN);
      return true;
    }
    const auto size = std::min<std::size_t>(reports_.front().size(), static_cast<std::size_t>(buffer->data_len));
    std::copy_n(reports_.front().begin(), size, buffer->data);
    reports_.pop_front();
    umockdev_ioctl_client_complete(client, static_cast<glong>(size), 0);
    return true;
  }

  testing::Bytes descriptor_ = testing::newer_mouse();

 private:
  std::mutex mutex_;
  std::deque<testing::Bytes> reports_;
  bool is_gone_ = false;
};

TEST_F(HidUmockdev, AMouseIsFoundReadAndLost) {
  plug_mouse();
  const HidBackend backend;
  const Backend::Listing found = backend.list();
  ASSERT_EQ(found.devices.size(), 1u);
  EXPECT_EQ(found.devices[0].model, "SpaceMouse Wireless");
  EXPECT_EQ(found.devices[0].serial, "S7");
  EXPECT_TRUE(found.missing.empty());
  auto opened = backend.open("0", {});
  ASSERT_TRUE(opened) << to_string(opened.error());
  Device& device = **opened;
  for (int i = 0; i < 1000; ++i) {
    const int value = i % 701 - 350;
    send(
        {1, static_cast<std::uint8_t>(value & 0xff), static_cast<std::uint8_t>(value >> 8 & 0xff), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    const auto reading = device.read(0);
    ASSERT_TRUE(reading);
    ASSERT_NEAR(reading->sample.position.x, value * 4e-6, 1e-12) << i;
  }
  send({3, 2, 0});
  EXPECT_EQ(device.read(0)->sample.buttons, 2u);
  unplug();
  EXPECT_STREQ(device.read(0).error().rule, "R-DEV-4");
}

TEST_F(HidUmockdev, OtherDevicesAreReadReportByReport) {
  descriptor_ = testing::gamepad();
  plug_mouse();
  const HidBackend backend;
  const Backend::Listing found = backend.list();
  ASSERT_EQ(found.devices.size(), 1u);
  EXPECT_EQ(found.devices[0].name, "hid:/dev/hidraw0");
  EXPECT_EQ(found.devices[0].report_descriptor, descriptor_);
  EXPECT_FALSE(backend.open("", {})) << "nobody takes one by chance";
  auto opened = backend.open("/dev/hidraw0", {});
  ASSERT_TRUE(opened) << to_string(opened.error());
  Device& device = **opened;
  testing::Bytes sent, heard;
  for (int i = 0; i < 1000; ++i) {
    for (std::uint8_t part = 0; part < i % 5; ++part) {
      send({part, static_cast<std::uint8_t>(i & 0xff), static_cast<std::uint8_t>(i >> 8)});
      sent.insert(sent.end(), {part, static_cast<std::uint8_t>(i & 0xff), static_cast<std::uint8_t>(i >> 8)});
    }
    ASSERT_TRUE(device.read(0));
    heard.insert(heard.end(), device.reports()->bytes.begin(), device.reports()->bytes.end());
  }
  EXPECT_EQ(heard, sent);
  unplug();
  EXPECT_STREQ(device.read(0).error().rule, "R-DEV-4");
}

}  // namespace
}  // namespace tactus::device::hid
