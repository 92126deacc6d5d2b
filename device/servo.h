// SPDX-License-Identifier: Apache-2.0
/// The loop between a device and whoever computes its force:
///
///   while (running) {
///     const auto tick = servo->next();              // waits: until the device's next sample, or the next tick of our clock
///     const Vec3 force = ...tick->reading.sample...;
///     servo->exert(force);                          // through the guard
///   }
///
/// Ticks have absolute times on the monotonic clock. A tick that comes a whole period late or more leaves out the ticks between: they
/// are counted, and the phase stays. A device with a clock is waited for instead of our clock, so that nothing beats.
///
/// A force is as old as the sample that it was computed from: a device that stays silent, or a caller that takes long, feels it fade.
/// A second thread watches: when no force was exerted for 15 ms while one acts (the caller hangs), it halts the device.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <thread>

#include <tactus/device/device.h>
#include <tactus/device/force_guard.h>
#include <tactus/device/real_time.h>

namespace tactus::device {

struct ServoOptions {
  double rate = 0;  ///< [Hz] 0: the device's own, or 1000
  GuardLimits limits{};
};

struct ServoTick {
  std::int64_t number = 0;  ///< from 0; ticks left out have numbers, too
  Time due = 0;             ///< when it should begin
  Time lateness =
      0;  ///< it began so long after the first tick that it replaces; of a device with a clock: after the sample was taken
  std::uint32_t missed = 0;  ///< ticks left out before this one
  Time age = 0;              ///< of the reading when the tick began
  Reading reading{};
};

struct ServoTimes {
  Histogram lateness, age;
  Histogram busy;  ///< from the beginning of a tick to the end of its exert()
  std::uint64_t ticks = 0, missed = 0;
  std::uint64_t halted = 0;  ///< by the thread that watches
};

class Servo {
 public:
  /// in   device, clock  outlive the servo; two threads ask the clock
  /// err  invalid_argument R-API-4: rate not in 1..10000, limits; limit_exceeded R-API-11: no thread
  static Result<std::unique_ptr<Servo>> start(Device& device, const ServoOptions& options, Clock& clock = monotonic_clock());

  /// Wait for the next tick, and read the device.   err  those of Device::read; the force is zero then
  Result<ServoTick> next() noexcept;
  /// Exert a force [N] on the hand, in the device frame; a device that takes none ignores it.   err  those of Device::write
  Result<void> exert(const Vec3& force) noexcept;

  const ServoTimes& times() noexcept;
  const ForceGuard* guard() const noexcept { return guard_ ? &*guard_ : nullptr; }  ///< null: the device takes no force
  Time period() const noexcept { return period_; }

  Servo(const Servo&) = delete;
  Servo& operator=(const Servo&) = delete;
  ~Servo();  ///< zero force

 private:
  Servo(Device& device, Clock& clock, Time period, const std::optional<ForceGuard>& guard);
  void watch(const std::stop_token& stop) noexcept;
  void wait() noexcept;
  void release() noexcept;

  Device& device_;
  Clock& clock_;
  Time period_;
  std::optional<ForceGuard> guard_;
  ServoTick tick_{};
  Time begun_ = 0;  // the tick
  Time late_ = 0;
  bool has_begun_ = false;
  ServoTimes times_;
  std::atomic<Time> exerted_{0};   // last
  std::atomic<bool> acts_{false};  // a force other than zero
  std::atomic<bool> is_halted_{false};
  std::atomic<std::uint64_t> halted_{0};
  std::jthread watcher_;
};

}  // namespace tactus::device
