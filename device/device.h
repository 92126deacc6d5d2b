// SPDX-License-Identifier: Apache-2.0
/// Force-feedback devices behind one interface. What a backend needs (a library, the vendor's runtime, a firmware file) is loaded when
/// one of its devices is asked for, not before.
///
/// Device frame: right-handed, x to the user's right, y away from the user, z up; the origin is the middle of the workspace.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include <tactus/base/diagnostic.h>
#include <tactus/base/geometry.h>
#include <tactus/trace/device_reports.h>

namespace tactus::device {

using Time = std::int64_t;  ///< [ns] on the machine's clock that never steps back (monotonic)
inline constexpr Time kMillisecond = 1'000'000;
inline constexpr Time kAnswerTime = 500 * kMillisecond;  ///< a device that says nothing for so long is gone (R-DEV-4)

/// What a device can do. What is not known is zero.
struct Capabilities {
  std::string name{};    ///< as Backend::open takes it, with the backend: "falcon:0"
  std::string model{};   ///< "Novint Falcon"
  std::string serial{};  ///< may be empty
  DeviceSenses senses{};
  unsigned buttons = 0;
  unsigned force_axes = 0;   ///< 0: it only listens, and takes no force
  Vec3 low{}, high{};        ///< [m] corners of the workspace, device frame
  double nominal_force = 0;  ///< [N] that it can hold
  double peak_force = 0;     ///< [N]
  double rate = 0;           ///< [Hz] at which it has new samples
  bool has_clock = false;    ///< read() waits for the device's own clock; otherwise it returns at once
  /// Nobody here interprets what the device says: it has no position, and what it says is handed on by reports(). What that means (HID
  /// 1.11, section 6.2.2).
  std::optional<std::vector<std::uint8_t>> report_descriptor{};
};

/// The newest sample, in the device frame.
struct Reading {
  enum class State : std::uint8_t {
    valid,
    not_homed,     ///< positions mean nothing yet: move the handle as the device asks
    out_of_reach,  ///< the pose is singular or impossible: the sample is the last one that was valid
    ended,         ///< a recording is over: the sample is its last one
  };
  DeviceSample sample{};
  Time taken = 0;  ///< when the device took it, as well as can be known
  State state = State::valid;
  std::uint32_t lost = 0;  ///< samples since the last call that nobody can have any more; only of a device with a clock
};

/// A force that passed a ForceGuard: nothing else makes one, and a device takes no other.
class GuardedForce {
 public:
  const Vec3& value() const noexcept { return value_; }  ///< [N] on the hand, device frame

 private:
  friend class ForceGuard;
  explicit GuardedForce(const Vec3& value) noexcept : value_(value) {}
  Vec3 value_;
};

/// An open device. One thread reads and writes it; no call allocates.
class Device {
 public:
  virtual const Capabilities& capabilities() const noexcept = 0;

  /// The newest sample. A device with a clock waits for the next one, at most until `deadline`; a simulated one, or a recording, is as it
  /// is at `deadline`.
  /// err  io R-DEV-4 it did not answer, or is gone; malformed R-DEV-5 it said what its protocol does not know. Both end its use.
  virtual Result<Reading> read(Time deadline) noexcept = 0;

  /// What came since the read() before, at most kMostReports; null: capabilities() has no report_descriptor.
  /// post  valid until the next read()
  virtual const DeviceReports* reports() const noexcept { return nullptr; }

  /// Exert a force until the next call.   pre  capabilities().force_axes > 0
  /// err  as read(); state R-DEV-6 a force before homing (zero is taken). The force is zero afterwards, as far as the device still obeys.
  virtual Result<void> write(const GuardedForce& force) noexcept = 0;

  /// Zero force at once, from any thread, also while another one is in read() or write(). The next write() exerts a force again.
  virtual void halt() noexcept = 0;

  virtual ~Device() = default;  ///< zero force, then lets the device go
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
};

/// What the user gives a backend to open a device with. Empty: the backend's own default.
struct OpenOptions {
  std::string firmware{};  ///< file, of a device that starts without any
  std::string runtime{};   ///< the vendor's library
  std::string service{};   ///< HOST:PORT of the vendor's program
};

/// A kind of devices.
class Backend {
 public:
  virtual const char* name() const noexcept = 0;   ///< "falcon"
  virtual const char* title() const noexcept = 0;  ///< "Novint Falcon (USB)"

  struct Listing {
    std::vector<Capabilities> devices;  ///< connected now; numbers of devices that were not opened may be zero
    std::vector<std::string> missing;   ///< sentences: what is needed and not there, and how to get it
  };
  /// Looks and touches nothing: no force, no firmware, no lock.
  virtual Listing list() const = 0;

  /// in   which  the part of Capabilities::name after the colon; empty: the first device
  /// err  invalid_argument R-DEV-1 no such device; io R-DEV-2 the system does not let us (permissions, in use); unsupported R-DEV-3 its
  ///      runtime, firmware or service is not there; R-DEV-4, R-DEV-5 as Device::read. The diagnostic says what to do.
  virtual tl::expected<std::unique_ptr<Device>, Diagnostic> open(const std::string& which, const OpenOptions& options) const = 0;

  virtual ~Backend() = default;
};

}  // namespace tactus::device
