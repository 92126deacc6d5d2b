// SPDX-License-Identifier: Apache-2.0
/// What the guard of a device did to the forces of a run.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include <tactus/device/servo.h>

namespace tactus::cli {

struct GuardReport {
  std::array<std::uint64_t, device::kGuardActions> ticks{};  ///< changed, per device::GuardAction
  std::vector<device::GuardEntry> log{};                     ///< actions that began; time since the run began
  double energy = 0;                                         ///< [J] that the hand was given
  std::uint64_t halted = 0;                                  ///< times that the loop hung
};

/// in   begin  of the run
/// out  none: the device takes no force
std::optional<GuardReport> guard_report(device::Servo& servo, device::Time begin);

nlohmann::ordered_json to_json(const GuardReport& report);
/// "12 clamp, 3 slew; halted 1 time"
std::string to_text(const GuardReport& report);

}  // namespace tactus::cli
