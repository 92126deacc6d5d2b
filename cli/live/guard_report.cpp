// SPDX-License-Identifier: Apache-2.0
#include "cli/live/guard_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/report/table.h"

namespace tactus::cli {

using Json = nlohmann::ordered_json;
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

Json to_json(const GuardReport& report) {
  Json ticks = Json::object(), log = Json::array();
  for (std::size_t i = 0; i < report.ticks.size(); ++i) ticks[name_of(static_cast<GuardAction>(i))] = report.ticks[i];
  const auto vector = [](const Vec3& v) { return Json{v.x, v.y, v.z}; };
  for (const device::GuardEntry& entry : report.log)
    log.push_back({{"time_s", 1e-9 * static_cast<double>(entry.time)},
                   {"action", name_of(entry.action)},
                   {"asked_N", is_finite(entry.asked) ? vector(entry.asked) : Json(nullptr)},
                   {"passed_N", vector(entry.passed)}});
  return {{"energy_given_J", report.energy}, {"halted", report.halted}, {"ticks", std::move(ticks)}, {"log", std::move(log)}};
}

std::string to_text(const GuardReport& report) {
  std::string text;
  for (std::size_t i = 0; i < report.ticks.size(); ++i)
    if (report.ticks[i] > 0)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", counted(report.ticks[i], "tick"),
                          name_of(static_cast<GuardAction>(i)));
  if (report.halted > 0) text += fmt::format("{}halted {}", text.empty() ? "" : "; ", counted(report.halted, "time"));
  return text.empty() ? "changed nothing" : text;
}

}  // namespace tactus::cli
