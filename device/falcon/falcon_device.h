// SPDX-License-Identifier: Apache-2.0
/// Novint Falcon: three axes, four buttons, USB. Its light is red until it is homed, then green, and blue while it is out of reach.
///
/// Each frame that goes out carries the force and brings a sample back. write() sends one at once; read() takes the answer, and sends one
/// itself if none is due. What was lost is asked for again; only silence for kAnswerTime ends the use of the device.
///
/// The Falcon keeps the last force that it was sent. If this process is killed, another one that open() started makes it let go.
#pragma once

#include <memory>
#include <string>

#include <tactus/device/device.h>
#include <tactus/device/falcon/falcon_usb.h>

namespace tactus::device::falcon {

class FalconBackend final : public Backend {
 public:
  explicit FalconBackend(std::unique_ptr<UsbBus> bus = real_bus());

  const char* name() const noexcept override { return "falcon"; }
  const char* title() const noexcept override { return "Novint Falcon (USB)"; }
  Listing list() const override;
  /// in   which  "0" is the first Falcon
  ///      options  firmware: needed once after the Falcon was switched on
  /// time up to 3 s
  tl::expected<std::unique_ptr<Device>, Diagnostic> open(const std::string& which, const OpenOptions& options) const override;

 private:
  std::unique_ptr<UsbBus> bus_;
};

/// What lets the user at the machine open a Falcon, as a line below /etc/udev/rules.d.
inline constexpr const char* kUdevRule = R"(SUBSYSTEM=="usb", ATTR{idVendor}=="0403", ATTR{idProduct}=="cb48", TAG+="uaccess")";

}  // namespace tactus::device::falcon
