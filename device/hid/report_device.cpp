// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/hid/report_device.h>

#include <algorithm>
#include <array>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/device/hid/report_descriptor.h>

namespace tactus::device::hid {
namespace {

class ReportDevice final : public Device {
 public:
  ReportDevice(std::unique_ptr<RawPort> port, Capabilities capabilities)
      : port_(std::move(port)), capabilities_(std::move(capabilities)) {
    reserve(reports_);
  }

  const Capabilities& capabilities() const noexcept override { return capabilities_; }
  const DeviceReports* reports() const noexcept override { return &reports_; }

  /// What came before it was gone is handed on first.
  Result<Reading> read(Time) noexcept override {
    reports_.sizes.clear();
    reports_.bytes.clear();
    while (!is_gone_ && has_room()) {
      const std::optional<std::size_t> size = port_->read(report_);
      if (!size) is_gone_ = true;
      else if (*size == 0) break;
      else take(std::span(report_).first(std::min(*size, report_.size())));
    }
    if (is_gone_ && reports_.sizes.empty()) return fail(Errc::io, "R-DEV-4");
    newest_.taken = port_->now();
    return newest_;
  }

  /// pre  never: it takes no force
  Result<void> write(const GuardedForce&) noexcept override { return fail(Errc::state, "R-DEV-6"); }
  void halt() noexcept override {}

 private:
  bool has_room() const noexcept {
    return reports_.sizes.size() < kMostReports && reports_.bytes.size() + report_.size() <= kMostReportBytes;
  }
  void take(std::span<const std::uint8_t> report) noexcept {
    reports_.sizes.push_back(static_cast<std::uint32_t>(report.size()));
    reports_.bytes.insert(reports_.bytes.end(), report.begin(), report.end());
  }

  std::unique_ptr<RawPort> port_;
  Capabilities capabilities_;
  std::array<std::uint8_t, kReportBytes> report_{};
  static_assert(kReportBytes <= kMostReportBytes);
  DeviceReports reports_;
  Reading newest_{};
  bool is_gone_ = false;
};

}  // namespace

Capabilities report_capabilities(const RawListing& listing) {
  Capabilities out;
  out.name = "hid:" + listing.path;
  out.model = listing.model;
  out.serial = listing.serial;
  out.report_descriptor = listing.descriptor;
  return out;
}

std::unique_ptr<Device> make_report_device(std::unique_ptr<RawPort> port, const RawListing& listing) {
  Capabilities about = report_capabilities(listing);
  about.report_descriptor = port->descriptor();
  return std::make_unique<ReportDevice>(std::move(port), std::move(about));
}

}  // namespace tactus::device::hid
