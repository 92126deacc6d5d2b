// SPDX-License-Identifier: Apache-2.0
/// Multi-axis controllers: HID devices with six axes, such as the SpaceMouse family. They are served by what their report descriptors say,
/// without a table of models, and take no force.
///
/// The position is how far the cap is pushed out of its middle, the orientation how far it is turned: a cap that springs back comes back
/// to zero. HID axes are x to the right, y towards the user, z down; turns are about them, right-handed.
/// Other HID devices have no position; asked for by path they hand on their reports as they come.
/// A device whose descriptor names no unit of length reaches kDefaultReach each way, one without a unit of angle kDefaultTurn.
#pragma once

#include <memory>
#include <string>

#include <tactus/device/device.h>
#include <tactus/device/hid/hid_raw.h>

namespace tactus::device::hid {

// ==== report device ====
// A HID device of any kind, whose reports are handed on as they come.

Capabilities report_capabilities(const RawListing& listing);

/// What comes beyond a tick's room is left in the system, which keeps 64 reports.
std::unique_ptr<Device> make_report_device(std::unique_ptr<RawPort> port, const RawListing& listing);

// ==== hid device ====

inline constexpr double kDefaultReach = 0.05;  ///< [m]
inline constexpr double kDefaultTurn = 0.5;    ///< [rad]

class HidBackend final : public Backend {
 public:
  explicit HidBackend(std::unique_ptr<RawBus> bus = real_bus());

  const char* name() const noexcept override { return "hid"; }
  const char* title() const noexcept override {
    return "SpaceMouse and other multi-axis controllers (HID); reports of other devices";
  }
  /// Controllers, and by their paths the other devices that may be opened.
  Listing list() const override;
  /// in   which  "0" is the first controller; "/dev/hidraw3" a device of any kind
  tl::expected<std::unique_ptr<Device>, Diagnostic> open(const std::string& which, const OpenOptions& options) const override;

 private:
  std::unique_ptr<RawBus> bus_;
};

/// What lets the user at the machine open a HID device, as a line below /etc/udev/rules.d; over USB and Bluetooth.
std::string udev_rule(std::uint16_t vendor, std::uint16_t product);

}  // namespace tactus::device::hid
