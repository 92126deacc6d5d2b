// SPDX-License-Identifier: Apache-2.0
/// A clock that a test moves, and a device that does what a test asks.
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <vector>

#include <tactus/device/device.h>
#include <tactus/device/real_time.h>

namespace tactus::device::testing {

class TestClock final : public Clock {
 public:
  Time now() noexcept override { return time; }
  void sleep_until(Time until) noexcept override { time = std::max<Time>(time, until) + lateness; }

  std::atomic<Time> time{1'000'000'000};
  Time lateness = 0;
};

inline Capabilities haptic_device() {
  Capabilities out;
  out.name = "test";
  out.force_axes = 3;
  out.nominal_force = 3;
  out.peak_force = 4;
  out.rate = 1000;
  return out;
}

class TestDevice final : public Device {
 public:
  const Capabilities& capabilities() const noexcept override { return can; }
  Result<Reading> read(Time deadline) noexcept override {
    if (read_error) return tl::unexpected(*read_error);
    reading.taken = deadline - age;
    return reading;
  }
  Result<void> write(const GuardedForce& passed) noexcept override {
    force = passed.value();
    ++writes;
    if (write_error) return tl::unexpected(*write_error);
    return {};
  }
  void halt() noexcept override { ++halts; }

  Capabilities can = haptic_device();
  Reading reading{};
  Time age = 0;  // of a reading
  Vec3 force{};
  int writes = 0;
  std::atomic<int> halts{0};
  std::optional<Error> read_error, write_error;
};

}  // namespace tactus::device::testing
