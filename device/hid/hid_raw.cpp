// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/hid/hid_raw.h>

#include <fcntl.h>
#include <linux/hidraw.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>

#include <tactus/device/hid/hidapi_library.h>
#include <tactus/device/real_time.h>

namespace tactus::device::hid {
namespace {

using Handle = std::unique_ptr<hid_device, decltype(&hid_close)>;
using List = std::unique_ptr<hid_device_info, decltype(&hid_free_enumeration)>;

/// What can be printed of it; vendors write names in ASCII.
std::string narrow(const wchar_t* text) {
  std::string out;
  for (; text != nullptr && *text != 0; ++text) out += *text >= 0x20 && *text < 0x7f ? static_cast<char>(*text) : '?';
  return out;
}

/// As the kernel shows it to everyone.
std::vector<std::uint8_t> shown_descriptor(const std::string& path) {
  std::ifstream file("/sys/class/hidraw/" + path.substr(path.rfind('/') + 1) + "/device/report_descriptor", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// As the open device reports it; empty: it does not.
std::vector<std::uint8_t> read_descriptor(int file) {
  int size = 0;
  hidraw_report_descriptor report{};
  if (ioctl(file, HIDIOCGRDESCSIZE, &size) < 0) return {};
  report.size = static_cast<std::uint32_t>(std::clamp(size, 0, HID_MAX_DESCRIPTOR_SIZE));
  if (ioctl(file, HIDIOCGRDESC, &report) < 0) return {};
  return {report.value, report.value + std::min<std::size_t>(report.size, HID_MAX_DESCRIPTOR_SIZE)};
}

class RealPort final : public RawPort {
 public:
  RealPort(const HidApi& hid, Handle handle, std::vector<std::uint8_t> descriptor)
      : hid_(hid), handle_(std::move(handle)), descriptor_(std::move(descriptor)) {}

  const std::vector<std::uint8_t>& descriptor() const noexcept override { return descriptor_; }

  std::optional<std::size_t> read(std::span<std::uint8_t> report) noexcept override {
    const int size = hid_.read_timeout(handle_.get(), report.data(), report.size(), 0);
    if (size < 0) return std::nullopt;
    return static_cast<std::size_t>(size);
  }

  Time now() const noexcept override { return monotonic_clock().now(); }

 private:
  HidApi hid_;
  Handle handle_;
  std::vector<std::uint8_t> descriptor_;
};

class RealBus final : public RawBus {
 public:
  tl::expected<std::vector<RawListing>, std::string> list() const override {
    TACTUS_TRY(const HidApi hid, HidApi::load());
    std::vector<RawListing> out;
    const List list(hid.enumerate(0, 0), hid.free_enumeration);
    for (const hid_device_info* one = list.get(); one != nullptr; one = one->next) {
      const std::string path = one->path;
      const auto is_same = [&path](const RawListing& other) {
        return other.path == path;
      };  // it stands there once per collection
      if (std::any_of(out.begin(), out.end(), is_same)) continue;
      out.push_back({path, narrow(one->product_string), narrow(one->serial_number), one->vendor_id, one->product_id,
                     access(path.c_str(), R_OK | W_OK) == 0, shown_descriptor(path)});
    }
    std::sort(out.begin(), out.end(), [](const RawListing& a, const RawListing& b) { return a.path < b.path; });
    return out;
  }

  tl::expected<std::unique_ptr<RawPort>, RawRefusal> open(const std::string& path) const override {
    const auto hid = HidApi::load();
    if (!hid) return tl::unexpected(RawRefusal::failed);
    const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
    if (file < 0) return tl::unexpected(errno == EACCES || errno == EPERM ? RawRefusal::denied : RawRefusal::gone);
    std::vector<std::uint8_t> descriptor = read_descriptor(file);
    ::close(file);
    Handle handle(hid->open_path(path.c_str()), hid->close);
    if (!handle || descriptor.empty()) return tl::unexpected(RawRefusal::failed);
    return std::make_unique<RealPort>(*hid, std::move(handle), std::move(descriptor));
  }
};

}  // namespace

std::unique_ptr<RawBus> real_bus() { return std::make_unique<RealBus>(); }

}  // namespace tactus::device::hid
