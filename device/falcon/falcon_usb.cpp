// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/falcon/falcon_usb.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <thread>

#include <tactus/device/falcon/libusb_library.h>
#include <tactus/device/guardian.h>
#include <tactus/device/real_time.h>

namespace tactus::device::falcon {
namespace {

constexpr std::uint16_t kVendor = 0x0403, kProduct = 0xcb48;
constexpr int kInterface = 0;
constexpr unsigned char kOut = 0x02, kIn = 0x81;    // bulk endpoints
constexpr std::uint8_t kVendorOut = 0x40;           // a vendor's request, from here to the device
constexpr Time kReleaseTime = 1000 * kMillisecond;  // of an interface whose owner ended
constexpr unsigned kAnswerMs = kAnswerTime / kMillisecond;

using Context = std::unique_ptr<libusb_context, decltype(&libusb_exit)>;
using Handle = std::unique_ptr<libusb_device_handle, decltype(&libusb_close)>;
using DeviceRef = std::unique_ptr<libusb_device, decltype(&libusb_unref_device)>;

UsbStatus status_of(int code) noexcept {
  switch (code) {
    case LIBUSB_SUCCESS:
      return UsbStatus::done;
    case LIBUSB_ERROR_TIMEOUT:
      return UsbStatus::timeout;
    case LIBUSB_ERROR_NO_DEVICE:
    case LIBUSB_ERROR_NOT_FOUND:
      return UsbStatus::gone;
    case LIBUSB_ERROR_ACCESS:
      return UsbStatus::denied;
    case LIBUSB_ERROR_BUSY:
      return UsbStatus::busy;
    default:
      return UsbStatus::failed;
  }
}

tl::expected<Context, int> start(const LibUsb& usb) {
  libusb_context* context = nullptr;
  if (const int code = usb.init(&context); code != 0) return tl::unexpected(code);
  return Context(context, usb.exit);
}

std::vector<DeviceRef> falcons(const LibUsb& usb, libusb_context* context) {
  std::vector<DeviceRef> out;
  libusb_device** list = nullptr;
  const ssize_t count = usb.get_device_list(context, &list);
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor about{};
    if (usb.get_device_descriptor(list[i], &about) == 0 && about.idVendor == kVendor && about.idProduct == kProduct)
      out.emplace_back(usb.ref_device(list[i]), usb.unref_device);
  }
  if (count >= 0) usb.free_device_list(list, 1);
  return out;
}

bool may_open(const LibUsb& usb, libusb_device* device) {
  std::array<char, 64> node{};
  const int bus = usb.get_bus_number(device), address = usb.get_device_address(device);
  std::snprintf(node.data(), node.size(), "/dev/bus/usb/%03d/%03d", bus, address);
  return access(node.data(), R_OK | W_OK) == 0;
}

std::string serial_of(const LibUsb& usb, libusb_device_handle* handle) {
  libusb_device_descriptor about{};
  std::array<unsigned char, 128> text{};
  if (usb.get_device_descriptor(usb.get_device(handle), &about) != 0 || about.iSerialNumber == 0) return {};
  const int size = usb.get_string_descriptor_ascii(handle, about.iSerialNumber, text.data(), static_cast<int>(text.size()));
  return std::string(text.begin(), text.begin() + std::max(size, 0));
}

class RealPort final : public UsbPort {
 public:
  RealPort(const LibUsb& usb, Context context, Handle handle, std::unique_ptr<Guardian> guardian)
      : usb_(usb),
        guardian_(std::move(guardian)),
        context_(std::move(context)),
        handle_(std::move(handle)),
        serial_(serial_of(usb_, handle_.get())) {}
  ~RealPort() override { usb_.release_interface(handle_.get(), kInterface); }

  UsbStatus control(std::uint8_t request, std::uint16_t value) noexcept override {
    return status_of(std::min(usb_.control_transfer(handle_.get(), kVendorOut, request, value, 0, nullptr, 0, kAnswerMs), 0));
  }

  UsbTransfer write(std::span<const std::uint8_t> bytes) noexcept override {
    // libusb takes one type for both directions and does not write what it sends.
    return transfer(kOut, const_cast<std::uint8_t*>(bytes.data()), bytes.size(), kAnswerMs);
  }

  UsbTransfer read(std::span<std::uint8_t> bytes, Time deadline) noexcept override {
    const Time left = (deadline - now() + kMillisecond - 1) / kMillisecond;
    return transfer(kIn, bytes.data(), bytes.size(), static_cast<unsigned>(std::clamp<Time>(left, 1, kAnswerMs)));
  }

  Time now() const noexcept override { return monotonic_clock().now(); }

  const std::string& serial() const noexcept override { return serial_; }

 private:
  UsbTransfer transfer(unsigned char endpoint, std::uint8_t* bytes, std::size_t size, unsigned most_ms) noexcept {
    int moved = 0;
    const int code = usb_.bulk_transfer(handle_.get(), endpoint, bytes, static_cast<int>(size), &moved, most_ms);
    return {status_of(code), static_cast<std::size_t>(moved)};
  }

  LibUsb usb_;
  std::unique_ptr<Guardian> guardian_;  // until the handle is closed
  Context context_;
  Handle handle_;
  std::string serial_;
};

/// in   guardian  null: none
tl::expected<std::unique_ptr<UsbPort>, UsbStatus> open_port(std::size_t index, std::unique_ptr<Guardian> guardian) {
  const auto usb = LibUsb::load();
  if (!usb) return tl::unexpected(UsbStatus::no_library);
  auto context = start(*usb);
  if (!context) return tl::unexpected(status_of(context.error()));
  libusb_device_handle* raw = nullptr;
  {
    const std::vector<DeviceRef> devices = falcons(*usb, context->get());
    if (index >= devices.size()) return tl::unexpected(UsbStatus::gone);
    if (const int code = usb->open(devices[index].get(), &raw); code != 0) return tl::unexpected(status_of(code));
  }
  Handle handle(raw, usb->close);
  usb->set_auto_detach_kernel_driver(raw, 1);
  if (const int code = usb->claim_interface(raw, kInterface); code != 0) return tl::unexpected(status_of(code));
  return std::make_unique<RealPort>(*usb, *std::move(context), std::move(handle), std::move(guardian));
}

/// For a process that ended: the system takes its interface back soon.
void say_last(std::size_t index, std::span<const std::uint8_t> words) {
  const Time deadline = monotonic_clock().now() + kReleaseTime;
  do {
    const auto port = open_port(index, nullptr);
    if (port && (*port)->write(words).status == UsbStatus::done) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  } while (monotonic_clock().now() < deadline);
}

class RealBus final : public UsbBus {
 public:
  tl::expected<std::vector<bool>, std::string> list() const override {
    TACTUS_TRY(const LibUsb usb, LibUsb::load());
    const auto context = start(usb);
    if (!context) return tl::unexpected(std::string("libusb does not start: ") + usb.error_name(context.error()));
    std::vector<bool> out;
    for (const DeviceRef& device : falcons(usb, context->get())) out.push_back(may_open(usb, device.get()));
    return out;
  }

  tl::expected<std::unique_ptr<UsbPort>, UsbStatus> open(std::size_t index,
                                                         std::span<const std::uint8_t> last_words) const override {
    // Started ahead of libusb, whose threads would not go on in another process.
    auto guardian = Guardian::start(
        [index, words = std::vector<std::uint8_t>(last_words.begin(), last_words.end())] { say_last(index, words); });
    if (!guardian) return tl::unexpected(UsbStatus::failed);
    return open_port(index, *std::move(guardian));
  }
};

}  // namespace

std::unique_ptr<UsbBus> real_bus() { return std::make_unique<RealBus>(); }

}  // namespace tactus::device::falcon
