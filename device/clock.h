// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/device/device.h>

namespace tactus::device {

/// What a servo loop waits on. Tests have their own.
class Clock {
 public:
  virtual Time now() noexcept = 0;
  virtual void sleep_until(Time time) noexcept = 0;

  virtual ~Clock() = default;
  Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
};

/// CLOCK_MONOTONIC: a step of the wall clock does not reach it.
Clock& monotonic_clock() noexcept;

}  // namespace tactus::device
