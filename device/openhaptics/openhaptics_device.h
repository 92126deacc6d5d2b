// SPDX-License-Identifier: Apache-2.0
/// Touch, Touch X and Phantom through the vendor's runtime. Its thread calls us at the device's rate; between it and us stand
/// hd_runtime.h. When the program hangs, that thread itself lets the force fade; when it dies, the thread dies with it, and the device
/// is left to its own watchdog.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <tactus/device/device.h>

namespace tactus::device::openhaptics {

class OpenHapticsBackend final : public Backend {
 public:
  const char* name() const noexcept override { return "openhaptics"; }
  const char* title() const noexcept override { return "Touch, Touch X, Phantom (the vendor's runtime)"; }
  /// Looks whether the runtime is installed, without loading it: only that knows which devices there are.
  Listing list() const override;
  /// in   which    the device's name in the vendor's configuration; empty: its default device
  ///      options  runtime: the library
  /// time up to some seconds: the runtime looks for the device
  tl::expected<std::unique_ptr<Device>, Diagnostic> open(const std::string& which, const OpenOptions& options) const override;
};

/// A sample of the runtime in SI units and the device frame; nothing if a number is not finite or the transform no rotation.
struct RawSample;
std::optional<DeviceSample> sample_of(const RawSample& raw) noexcept;

}  // namespace tactus::device::openhaptics
