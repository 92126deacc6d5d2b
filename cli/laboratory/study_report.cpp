// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/study_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include <tactus/trace/csv_reader.h>
#include "cli/laboratory/cmd_bench.h"
#include "cli/report/json_parts.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;
using sim::study::Row;
using sim::study::Study;

const char* extent_name(sim::study::Extent extent) { return extent == sim::study::Extent::full ? "full" : "short"; }

std::string figure(const std::optional<double>& value, const std::string& unit) {
  if (!value) return "-";
  return fmt::format("{:.5g}{}{}", *value, unit.empty() ? "" : " ", unit);
}

std::string deviation(const Row& row) {
  const auto value = row.deviation();
  if (!value) return "-";
  const std::string text = fmt::format("{:+.2f} %", 100 * *value);
  return text == "-0.00 %" || text == "+0.00 %" ? "0.00 %" : text;
}

std::string parameters(const Row& row, const char* between) {
  std::string out;
  for (const auto& p : row.parameters)
    out += fmt::format("{}{} {:.4g}{}{}", out.empty() ? "" : between, p.name, p.value, p.unit.empty() ? "" : " ", p.unit);
  return out;
}

std::string exact(const std::optional<double>& value) { return value ? fmt::format("{:.9g}", *value) : ""; }

std::string markdown(const sim::study::Matrix& matrix) {
  std::string out = "\n| " + matrix.corner, line = "\n|---";
  for (const std::string& column : matrix.columns) {
    out += " | " + column;
    line += "|---";
  }
  out += " |" + line + "|\n";
  for (const auto& [label, cells] : matrix.rows) out += fmt::format("| {} | {} |\n", label, fmt::join(cells, " | "));
  return out;
}

std::array<std::size_t, 3> verdicts(const Study& study) {
  std::array<std::size_t, 3> out{};
  for (const Row& row : study.rows) ++out[static_cast<std::size_t>(row.verdict)];
  return out;
}

}  // namespace

void print_table(std::span<const Study> studies, std::FILE* out) {
  Table table;
  for (const Study& study : studies) {
    table.heading({study.title, "with", "measured", "", "theory", "off by", "verdict", "remark"});
    for (const Row& row : study.rows)
      if (!row.detail)
        table.row({"  " + row.subject, parameters(row, ", "), row.quantity, figure(row.measured, row.unit),
                   figure(row.analytic, row.unit), deviation(row), name(row.verdict), row.remark});
  }
  table.print(out);
  for (const Study& study : studies) {
    if (study.matrix.rows.empty()) continue;
    Table matrix;
    std::vector<std::string> head{study.title + ", " + study.matrix.corner};
    head.insert(head.end(), study.matrix.columns.begin(), study.matrix.columns.end());
    matrix.heading(std::move(head));
    for (const auto& [label, cells] : study.matrix.rows) {
      std::vector<std::string> line{"  " + label};
      line.insert(line.end(), cells.begin(), cells.end());
      matrix.row(std::move(line));
    }
    fmt::print(out, "\n");
    matrix.print(out);
  }
}

std::string to_csv(std::span<const Study> studies) {
  std::string out = "study,subject,parameters,verdict,quantity,measured,analytic,unit,deviation,remark\n";
  for (const Study& study : studies)
    for (const Row& row : study.rows)
      out += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", study.name, csv_field(row.subject), csv_field(parameters(row, "; ")),
                         name(row.verdict), csv_field(row.quantity), exact(row.measured), exact(row.analytic), row.unit,
                         exact(row.deviation()), csv_field(row.remark));
  return out;
}

std::string to_json(std::span<const Study> studies, sim::study::Extent extent) {
  Json out{{"schema", "tactus.stability/1"}, {"extent", extent_name(extent)}, {"context", bench_context()}};
  const auto optional = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  for (const Study& study : studies) {
    const auto [stable, limit, diverges] = verdicts(study);
    Json entry{{"study", study.name}, {"title", study.title}, {"stable", stable}, {"limit", limit}, {"diverges", diverges}};
    for (const Row& row : study.rows) {
      Json one{{"subject", row.subject}, {"parameters", Json::object()}, {"verdict", name(row.verdict)}};
      for (const auto& p : row.parameters) one["parameters"][p.name] = {{"value", p.value}, {"unit", p.unit}};
      one["quantity"] = row.quantity;
      one["unit"] = row.unit;
      one["measured"] = optional(row.measured);
      one["analytic"] = optional(row.analytic);
      one["deviation"] = optional(row.deviation());
      one["remark"] = row.remark;
      entry["rows"].push_back(std::move(one));
    }
    out["studies"].push_back(std::move(entry));
  }
  return text_of_json(out) + "\n";
}

std::string to_markdown(std::span<const Study> studies, std::span<const Picture> pictures, sim::study::Extent extent) {
  const auto context = bench_context();
  std::string out = fmt::format(
      "# Where the simulation stops being stable\n\n"
      "`tactus bench stability{}` on {} ({}, {} build). Every study is deterministic; no figure here is a time.\n\n"
      "*stable*: what was disturbed comes to rest, or stays within what the disturbance explains. *limit*: a limit was measured, "
      "or the motion goes on within bounds. *diverges*: the motion grows without bound, or a step was refused with an error and "
      "the state before it was kept. The same rows are in `stability.csv` and `stability.json`.\n",
      extent == sim::study::Extent::full ? "" : " --short", context.at("machine"), context.at("compiler"), context.at("build"));
  for (const Study& study : studies) {
    out += fmt::format("\n## {}\n\n{}\n", study.title, study.text);
    for (const Picture& picture : pictures)
      if (picture.name.starts_with(study.name + "-"))
        out += fmt::format("\n![{1}]({0}.svg)\n\n*{1}*\n", picture.name, picture.caption);
    if (!study.matrix.rows.empty()) out += markdown(study.matrix);
    out += "\n| what | with | quantity | measured | theory | off by | verdict | remark |\n|---|---|---|---:|---:|---:|---|---|\n";
    for (const Row& row : study.rows) {
      if (row.detail) continue;
      out += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", row.subject, parameters(row, ", "), row.quantity,
                         figure(row.measured, row.unit), figure(row.analytic, row.unit), deviation(row), name(row.verdict),
                         row.remark);
    }
  }
  return out;
}

}  // namespace tactus::cli
