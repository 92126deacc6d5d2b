// SPDX-License-Identifier: Apache-2.0
#include "cli/live/guard_report.h"

#include "cli/report/json.h"

namespace tactus::cli {

using device::GuardAction;

std::optional<GuardReport> guard_report(device::Servo& servo, device::Time begin) {
  const device::ForceGuard* const guard = servo.guard();
  if (guard == nullptr) return std::nullopt;
  GuardReport report{
      .log = {guard->log().begin(), guard->log().end()}, .energy = guard->energy(), .halted = servo.times().halted};
  for (std::size_t i = 0; i < report.ticks.size(); ++i) report.ticks[i] = guard->count(static_cast<GuardAction>(i));
  for (device::GuardEntry& entry : report.log) entry.time -= begin;
  return report;
}

Value value_of(const GuardReport& report) {
  Json ticks = Json::object(), log = Json::array();
  for (std::size_t i = 0; i < report.ticks.size(); ++i) ticks[name_of(static_cast<GuardAction>(i))] = report.ticks[i];
  const auto vector = [](const Vec3& v) { return Json{v.x, v.y, v.z}; };
  for (const device::GuardEntry& entry : report.log)
    log.push_back({{"time_s", 1e-9 * static_cast<double>(entry.time)},
                   {"action", name_of(entry.action)},
                   {"asked_N", is_finite(entry.asked) ? vector(entry.asked) : Json(nullptr)},
                   {"passed_N", vector(entry.passed)}});
  return Json{{"energy_given_J", report.energy}, {"halted", report.halted}, {"ticks", std::move(ticks)}, {"log", std::move(log)}};
}

}  // namespace tactus::cli
