// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/precision_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/report/json_parts.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;
using sim::study::PrecisionPoint;
using sim::study::SpacePoint;

std::string scientific(double value) { return std::isfinite(value) ? fmt::format("{:.1e}", value) : "-"; }
std::string significant(double value) { return std::isfinite(value) ? fmt::format("{:.3g}", value) : "-"; }
std::string milliseconds(double seconds) { return fmt::format("{:.3g}", 1e3 * seconds); }

using Cells = std::vector<std::string>;

Cells time_heading() {
  return {"method", "h [ms]", "u",       "u, end", "v",          "force",  "energy",
          "weight", "push",   "ms/step", "s/s",    "setup [ms]", "Newton", "solver"};
}

std::string method_of(const PrecisionPoint& p) { return p.taken.empty() ? p.method : p.method + ": " + p.taken; }

Cells cells_of(const PrecisionPoint& p) {
  if (!std::isfinite(p.errors.displacement)) return {method_of(p), milliseconds(p.step), "stopped"};
  return {method_of(p),
          milliseconds(p.step),
          scientific(p.errors.displacement),
          scientific(p.errors.displacement_end),
          scientific(p.errors.velocity),
          scientific(p.errors.force),
          scientific(p.errors.energy),
          scientific(p.errors.weight),
          scientific(p.errors.push),
          milliseconds(p.seconds_per_step()),
          significant(p.seconds_per_second),
          milliseconds(p.setup_seconds),
          significant(p.newton_per_step),
          significant(p.solver_per_step)};
}

Cells space_heading() {
  return {"edge", "tets", "static [mm/N]", "error", "quadratic [mm/N]", "error", "in time, error", "h [ms]", "s/s"};
}

std::string percent(double value) { return std::isfinite(value) ? fmt::format("{:.2g} %", 100 * value) : "-"; }

Cells cells_of(const SpaceStudy& space, std::size_t i) {
  const SpacePoint& p = space.points[i];
  const bool in_time = p.step > 0, quadratic = p.quadratic_deflection > 0;
  return {fmt::format("1/{}", p.refinement),
          fmt::to_string(p.tets),
          fmt::format("{:.4g}", 1e3 * p.at_rest.deflection),
          percent(space.errors.at_rest_error[i]),
          quadratic ? fmt::format("{:.4g}", 1e3 * p.quadratic_deflection) : "-",
          percent(space.errors.quadratic_error[i]),
          percent(space.errors.transient_error[i]),
          in_time ? milliseconds(p.step) : "-",
          in_time ? significant(p.seconds_per_second) : "-"};
}

std::string limit_text(const SpaceStudy& space) {
  const auto& limit = space.errors.limit;
  return fmt::format("limit of quadratic elements {:.4g} +- {:.2g} mm/N, their observed order {:.2f}", 1e3 * limit.limit,
                     1e3 * limit.uncertainty, limit.order);
}

std::string space_title(const SpaceStudy& space) {
  return fmt::format("{}, nu {:.3g}", space.scene, space.points.front().poisson);
}

std::string reference_text(const TimeStudy& time) {
  const sim::study::Errors& floor = time.reference.errors;
  return fmt::format(
      "reference: Runge-Kutta of order 4, not among the methods compared, h = {:.3g} us, {}; its own error: u {}, v {}, force "
      "{}, energy {}, weight {}, push {}",
      1e6 * time.reference.step, time.reference.remark, scientific(floor.displacement), scientific(floor.velocity),
      scientific(floor.force), scientific(floor.energy), scientific(floor.weight), scientific(floor.push));
}

/// What is not in the tables, or only in part, and why.
std::vector<std::string> omissions(const TimeStudy& time) {
  std::vector<std::string> out;
  const int smallest = time.scene.steps_per_sample.back();
  for (std::size_t i = 0; i < time.points.size(); ++i) {
    const PrecisionPoint& p = time.points[i];
    const std::string place = fmt::format("{}, h = {} ms: ", p.method, milliseconds(p.step));
    if (!p.remark.empty()) out.push_back(place + p.remark);
    else if (!is_usable(p.errors.displacement)) out.push_back(place + "finished, but no better than standing still");
    const bool is_last = i + 1 == time.points.size() || time.points[i + 1].method != p.method;
    if (is_last && p.steps_per_sample != smallest)
      out.push_back(fmt::format("{}, h below {} ms: left out, {:.2g} times slower than real time there already", p.method,
                                milliseconds(p.step), p.seconds_per_second));
  }
  return out;
}

std::string markdown_row(const Cells& cells, std::size_t columns) {
  std::string out = "|";
  for (std::size_t i = 0; i < columns; ++i) out += fmt::format(" {} |", i < cells.size() ? cells[i] : "");
  return out + '\n';
}

std::string markdown_heading(const Cells& cells) {
  std::string out = markdown_row(cells, cells.size()) + "|---|";
  for (std::size_t i = 1; i < cells.size(); ++i) out += "---:|";
  return out + '\n';
}

std::string markdown_of(const TimeStudy& time) {
  const std::string& name = time.scene.name;
  std::string out =
      fmt::format("\n## {}\n\n{}, {} vertices, {} tetrahedra, {} s.\n{}.\n\n", name, time.scene.title,
                  time.scene.mesh.vertices.size(), time.scene.mesh.tets.size(), time.scene.duration, reference_text(time));
  for (const char* quantity : {"displacement", "force", "energy", "weight"})
    out += fmt::format("![{0}: run time against error of {1}]({0}-{1}.svg)\n", name, quantity);
  out += '\n' + markdown_heading(time_heading());
  for (const PrecisionPoint& p : time.points) out += markdown_row(cells_of(p), time_heading().size());
  const auto left_out = omissions(time);
  if (!left_out.empty()) out += "\n### Omissions\n\n";
  for (const std::string& text : left_out) out += "* " + text + '\n';
  return out;
}

std::string markdown_of(const SpaceStudy& space) {
  std::string out =
      fmt::format("\n### {}\n\n{}.\n\n{}", space_title(space), limit_text(space), markdown_heading(space_heading()));
  for (std::size_t i = 0; i < space.points.size(); ++i) {
    out += markdown_row(cells_of(space, i), space_heading().size());
  }
  return out;
}

/// The row of a method at 1 ms in every study: error of u under the smooth load, under weight, processor time.
Cells at_one_millisecond(const PrecisionReport& report, const std::string& method) {
  Cells out{method};
  for (const TimeStudy& time : report.times) {
    const auto point = std::find_if(time.points.begin(), time.points.end(), [&](const PrecisionPoint& p) {
      return p.method == method && std::abs(p.step - 1e-3) < 1e-9;
    });
    const bool there = point != time.points.end() && std::isfinite(point->errors.displacement);
    if (there)
      out.insert(out.end(), {scientific(point->errors.displacement), scientific(point->errors.weight),
                             milliseconds(point->seconds_per_step())});
    else out.insert(out.end(), {"stopped", "", ""});
  }
  return out;
}

std::string markdown_at_one_millisecond(const PrecisionReport& report) {
  Cells heading{"method"};
  for (const TimeStudy& time : report.times)
    for (const char* column : {"u", "weight", "ms/step"}) heading.push_back(time.scene.name + ": " + column);
  std::string out = "\n## At 1 kHz\n\n" + markdown_heading(heading);
  if (report.times.empty()) return out;
  for (const sim::study::PrecisionMethod& method : report.times.front().methods)
    out += markdown_row(at_one_millisecond(report, method.name), heading.size());
  return out;
}

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json json_of(const PrecisionPoint& p) {
  Json out{{"method", p.method},
           {"step_s", p.step},
           {"displacement_error", finite(p.errors.displacement)},
           {"displacement_end_error", finite(p.errors.displacement_end)},
           {"velocity_error", finite(p.errors.velocity)},
           {"force_error", finite(p.errors.force)},
           {"energy_error", finite(p.errors.energy)},
           {"weight_error", finite(p.errors.weight)},
           {"push_error", finite(p.errors.push)},
           {"seconds_per_second", p.seconds_per_second},
           {"seconds_per_step", p.seconds_per_step()},
           {"setup_s", p.setup_seconds},
           {"runs", p.runs},
           {"newton_per_step", p.newton_per_step},
           {"solver_iterations_per_step", p.solver_per_step},
           {"unconverged_steps", p.unconverged_steps}};
  if (!p.taken.empty()) out["taken"] = p.taken;
  if (!p.remark.empty()) out["remark"] = p.remark;
  return out;
}

Json json_of(const SpaceStudy& space) {
  const auto& limit = space.errors.limit;
  Json out{{"scene", space.scene},
           {"poisson", space.points.front().poisson},
           {"limit_m_per_n", limit.limit},
           {"limit_uncertainty_m_per_n", limit.uncertainty},
           {"observed_order", limit.order}};
  for (std::size_t i = 0; i < space.points.size(); ++i) {
    const SpacePoint& p = space.points[i];
    out["points"].push_back({{"refinement", p.refinement},
                             {"vertices", p.vertices},
                             {"tets", p.tets},
                             {"deflection_m_per_n", p.at_rest.deflection},
                             {"static_error", space.errors.at_rest_error[i]},
                             {"quadratic_error", finite(space.errors.quadratic_error[i])},
                             {"transient_error", finite(space.errors.transient_error[i])},
                             {"step_s", p.step},
                             {"seconds_per_second", p.seconds_per_second}});
  }
  return out;
}

}  // namespace

bool is_usable(double error) noexcept { return error > 0 && error < 1; }

void print_precision_tables(const PrecisionReport& report) {
  for (const TimeStudy& time : report.times) {
    fmt::print("{}\n{}\n\n", time.scene.title, reference_text(time));
    Table table;
    const std::string* method = nullptr;
    for (const PrecisionPoint& p : time.points) {
      Cells cells = cells_of(p);
      if (method == nullptr) table.heading(time_heading());
      if (method != nullptr && *method == p.method && p.taken.empty()) cells[0] = "";
      method = &p.method;
      table.row(std::move(cells));
    }
    table.print(stdout);
    for (const std::string& text : omissions(time)) fmt::print("{}\n", text);
    fmt::print("\n");
  }
  for (const SpaceStudy& space : report.spaces) {
    fmt::print("space error, {}: {}\n\n", space_title(space), limit_text(space));
    Table table;
    table.heading(space_heading());
    for (std::size_t i = 0; i < space.points.size(); ++i) table.row(cells_of(space, i));
    table.print(stdout);
    fmt::print("\n");
  }
}

std::string precision_json(const PrecisionReport& report) {
  Json out{{"schema", "tactus.precision/1"}, {"context", report.context}};
  for (const TimeStudy& time : report.times) {
    Json entry{{"scene", time.scene.name},
               {"seconds", time.scene.duration},
               {"vertices", time.scene.mesh.vertices.size()},
               {"tets", time.scene.mesh.tets.size()},
               {"reference", json_of(time.reference)}};
    for (const PrecisionPoint& p : time.points) entry["points"].push_back(json_of(p));
    out["time"].push_back(std::move(entry));
  }
  for (const SpaceStudy& space : report.spaces) out["space"].push_back(json_of(space));
  return text_of_json(out) + '\n';
}

std::string precision_markdown(const PrecisionReport& report) {
  std::string out =
      "# Error against run time\n\n"
      "Made by `tactus bench precision`. The columns are relative errors over all sample times: of displacement (`u`; `u, end` "
      "only at the\nlast one), velocity (`v`) and energy under a load that grows from zero, of the force of a probe, and of the "
      "displacements under self weight\n(`weight`) and load (`push`) applied at once; then processor time per step, seconds of "
      "one core per simulated second (`s/s`; below 1:\nfaster than real time), time up to the second step (`setup`), Newton and "
      "solver iterations per step. Times are medians. `chosen` is the\nmethod that `tactus sim` takes.\n\n";
  for (const auto& [key, value] : report.context) out += fmt::format("* {}: {}\n", key, value);
  out += markdown_at_one_millisecond(report);
  for (const TimeStudy& time : report.times) out += markdown_of(time);
  if (report.spaces.empty()) return out;
  out +=
      "\n## Space error\n\nError of the loaded patch's mean deflection against its limit under refinement. No time step reduces "
      "it.\n\n";
  for (const SpaceStudy& space : report.spaces) {
    const std::string image = fmt::format("![{0}: space error](space-{0}.svg)\n", space.scene);
    if (out.find(image) == std::string::npos) out += image;
  }
  for (const SpaceStudy& space : report.spaces) out += markdown_of(space);
  return out;
}

}  // namespace tactus::cli
