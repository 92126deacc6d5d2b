// SPDX-License-Identifier: Apache-2.0
/// What the guard of a device did to the forces of a run.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <tactus/device/servo.h>

namespace tactus::cli {

struct Value;

struct GuardReport {
  std::array<std::uint64_t, device::kGuardActions> ticks{};  ///< changed, per device::GuardAction
  std::vector<device::GuardEntry> log{};                     ///< actions that began; time since the run began
  double energy = 0;                                         ///< [J] that the hand was given
  std::uint64_t halted = 0;                                  ///< times that the loop hung
};

/// in   begin  of the run
/// out  none: the device takes no force
std::optional<GuardReport> guard_report(device::Servo& servo, device::Time begin);

Value value_of(const GuardReport& report);
}  // namespace tactus::cli
