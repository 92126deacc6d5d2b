// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/hid/hid_device.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/base/text.h>
#include <tactus/device/hid/report_descriptor.h>

namespace tactus::device::hid {

// ==== report device ====

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

// ==== hid device ====

namespace {

constexpr std::size_t kAxes = 6;
constexpr int kMostReports = 1000;  // read at once

// Units of HID [m], [rad].
constexpr std::uint32_t kCentimetre = 0x11, kRadian = 0x12, kInch = 0x13, kDegree = 0x14;

/// An axis and what its values mean.
struct Axis {
  Field field;
  double middle = 0;
  double scale = 0;  // [m] or [rad]
};

struct Layout {
  std::array<Axis, kAxes> axes;
  std::vector<Field> buttons;
};

/// None: the unit is another one.
std::optional<double> si(std::uint32_t unit, bool is_turn) noexcept {
  switch (unit) {
    case kCentimetre:
      return is_turn ? std::nullopt : std::optional(0.01);
    case kInch:
      return is_turn ? std::nullopt : std::optional(0.0254);
    case kRadian:
      return is_turn ? std::optional(1.0) : std::nullopt;
    case kDegree:
      return is_turn ? std::optional(std::numbers::pi / 180) : std::nullopt;
    default:
      return std::nullopt;
  }
}

Axis axis_of(const Field& field, bool is_turn) noexcept {
  const auto range = static_cast<double>(field.logical_high - field.logical_low);
  const auto physical = static_cast<double>(field.physical_high - field.physical_low);
  const std::optional<double> unit = si(field.unit, is_turn);
  const double reach = is_turn ? kDefaultTurn : kDefaultReach;
  return {field, 0.5 * static_cast<double>(field.logical_low + field.logical_high),
          unit ? *unit * std::pow(10.0, field.exponent) * physical / range : 2 * reach / range};
}

/// None: it is no multi-axis controller with all six axes.
std::optional<Layout> layout_of(std::span<const std::uint8_t> descriptor) {
  const auto fields = parse_report_descriptor(descriptor);
  if (!fields) return std::nullopt;
  Layout out;
  unsigned found = 0;
  for (const Field& field : *fields) {
    if (field.application != kMultiAxisController) continue;
    if (field.usage > kButtons) {
      out.buttons.push_back(field);
      continue;
    }
    const std::size_t axis = field.usage - kAxisX;
    if ((found >> axis & 1u) == 0) out.axes[axis] = axis_of(field, axis >= 3);
    found |= 1u << axis;
  }
  return found == (1u << kAxes) - 1 ? std::optional(std::move(out)) : std::nullopt;
}

/// From x right, y towards the user, z down to the device frame.
Vec3 turned(double x, double y, double z) noexcept { return {x, -y, -z}; }

Capabilities capabilities_of(const RawListing& listing, const Layout& layout, const std::string& which) {
  Capabilities out;
  out.name = "hid:" + which;
  out.model = listing.model;
  out.serial = listing.serial;
  out.senses.orientation = true;
  for (const Field& button : layout.buttons) out.buttons = std::max(out.buttons, button.usage - kButtons);
  out.senses.buttons = out.buttons > 0;
  const auto reach = [&layout](std::size_t axis) {
    const auto& [field, middle, scale] = layout.axes[axis];
    return scale * (static_cast<double>(field.logical_high) - middle);
  };
  out.high = {reach(0), reach(1), reach(2)};
  out.low = -out.high;
  return out;
}

Quat rotation_by(const Vec3& turn) noexcept {
  const double angle = norm(turn);
  const double ratio = angle > 1e-9 ? std::sin(angle / 2) / angle : 0.5;
  return {std::cos(angle / 2), ratio * turn.x, ratio * turn.y, ratio * turn.z};
}

class HidDevice final : public Device {
 public:
  HidDevice(std::unique_ptr<RawPort> port, Layout layout, Capabilities capabilities)
      : port_(std::move(port)), layout_(std::move(layout)), capabilities_(std::move(capabilities)) {}

  const Capabilities& capabilities() const noexcept override { return capabilities_; }

  /// Devices report changes: without news the last sample holds.
  Result<Reading> read(Time) noexcept override {
    for (int i = 0; !is_gone_ && i < kMostReports; ++i) {
      const std::optional<std::size_t> size = port_->read(report_);
      if (!size) is_gone_ = true;
      else if (*size == 0) break;
      else take(std::span(report_).first(std::min(*size, report_.size())));
    }
    if (is_gone_) return fail(Errc::io, "R-DEV-4");
    newest_.taken = port_->now();
    newest_.sample.position = turned(values_[0], values_[1], values_[2]);
    newest_.sample.orientation = rotation_by(turned(values_[3], values_[4], values_[5]));
    return newest_;
  }

  /// pre  never: it takes no force
  Result<void> write(const GuardedForce&) noexcept override { return fail(Errc::state, "R-DEV-6"); }
  void halt() noexcept override {}

 private:
  void take(std::span<const std::uint8_t> report) noexcept {
    for (std::size_t i = 0; i < kAxes; ++i) {
      const auto& [field, middle, scale] = layout_.axes[i];
      if (const auto value = value_in(report, field))
        values_[i] = scale * (static_cast<double>(std::clamp(*value, field.logical_low, field.logical_high)) - middle);
    }
    for (const Field& button : layout_.buttons) {
      const auto value = value_in(report, button);
      if (!value) continue;
      const std::uint32_t bit = 1u << (button.usage - kButtons - 1);
      newest_.sample.buttons = *value != 0 ? newest_.sample.buttons | bit : newest_.sample.buttons & ~bit;
    }
  }

  std::unique_ptr<RawPort> port_;
  Layout layout_;
  Capabilities capabilities_;
  std::array<std::uint8_t, kReportBytes> report_{};
  std::array<double, kAxes> values_{};  // [m], [rad] HID axes
  Reading newest_{};
  bool is_gone_ = false;
};

/// Whether one is named by a path.
bool is_path(const std::string& which) { return which.starts_with('/'); }

std::string permission(const RawListing& listing) {
  return "Write this line to /etc/udev/rules.d/70-hid.rules, then unplug the device and plug it in again: " +
         udev_rule(listing.vendor, listing.product);
}

tl::unexpected<Diagnostic> not_opened(const tl::unexpected<Error>& error, std::string detail, std::string remedy = {}) {
  Diagnostic out{error.value()};
  out.detail = std::move(detail);
  out.remedy = std::move(remedy);
  return tl::unexpected(std::move(out));
}

/// A number; none: it is none.
std::optional<std::size_t> index_of(const std::string& which) { return which.empty() ? 0 : parse_number<std::size_t>(which); }

/// By its path, or by its number among controllers; null: there is no such device.
const RawListing* find(const std::vector<RawListing>& listings, const std::string& which) {
  std::optional<std::size_t> left = index_of(which);
  for (const RawListing& listing : listings) {
    if (is_path(which) && listing.path == which) return &listing;
    if (left && layout_of(listing.descriptor) && (*left)-- == 0) return &listing;
  }
  return nullptr;
}

}  // namespace

std::string udev_rule(std::uint16_t vendor, std::uint16_t product) {
  std::array<char, 80> out{};
  std::snprintf(out.data(), out.size(), R"(KERNEL=="hidraw*", KERNELS=="*:%04X:%04X.*", TAG+="uaccess")", vendor, product);
  return out.data();
}

HidBackend::HidBackend(std::unique_ptr<RawBus> bus) : bus_(std::move(bus)) {}

Backend::Listing HidBackend::list() const {
  Listing out;
  const auto found = bus_->list();
  if (!found) {
    out.missing.push_back(found.error());
    return out;
  }
  std::vector<Capabilities> others;
  for (const RawListing& listing : *found) {
    const auto layout = layout_of(listing.descriptor);
    if (!layout && listing.may_open && !listing.descriptor.empty()) others.push_back(report_capabilities(listing));
    if (!layout) continue;
    out.devices.push_back(capabilities_of(listing, *layout, std::to_string(out.devices.size())));
    if (!listing.may_open) out.missing.push_back(out.devices.back().name + ": you may not open it. " + permission(listing));
  }
  std::ranges::move(others, std::back_inserter(out.devices));
  return out;
}

tl::expected<std::unique_ptr<Device>, Diagnostic> HidBackend::open(const std::string& which, const OpenOptions&) const {
  const auto found = bus_->list();
  const std::string name = "hid:" + (which.empty() ? "0" : which);
  if (!found) return not_opened(fail(Errc::unsupported, "R-DEV-3"), name + ": " + found.error());
  const RawListing* const listing = find(*found, which);
  if (listing == nullptr) return not_opened(fail(Errc::invalid_argument, "R-DEV-1"), name);
  auto port = bus_->open(listing->path);
  if (!port && port.error() == RawRefusal::denied) return not_opened(fail(Errc::io, "R-DEV-2"), name, permission(*listing));
  if (!port) return not_opened(fail(Errc::io, "R-DEV-4"), name + ": " + listing->path + " cannot be opened");
  std::optional<Layout> layout = layout_of((*port)->descriptor());
  if (!layout && is_path(which)) return make_report_device(*std::move(port), *listing);
  if (!layout) return not_opened(fail(Errc::malformed, "R-DEV-5"), name + ": its report descriptor changed");
  Capabilities about = capabilities_of(*listing, *layout, which.empty() ? "0" : which);
  return std::make_unique<HidDevice>(*std::move(port), *std::move(layout), std::move(about));
}

}  // namespace tactus::device::hid
