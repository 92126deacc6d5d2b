// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/delay_figure.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/report/json_parts.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;

/// Three digits, without those that say nothing.
std::string rounded(double value) {
  const double step = std::abs(value) < 10 ? 0.01 : 0.1;
  return fmt::format("{:g}", std::abs(value) < step / 2 ? 0 : std::round(value / step) * step);
}

Json to_json(const DelayFigure& figure) {
  Json out{{"schema", "tactus.reproduce_delay/1"}, {"figure", figure.figure}};
  for (const FigureNumber& q : figure.quantities) {
    Json entry{{"name", q.name}, {"unit", q.unit}};
    for (std::size_t i = 0; i < q.values.size(); ++i)
      if (q.values[i]) entry["values"][figure.columns[i]] = *q.values[i];
    out["quantities"].push_back(std::move(entry));
  }
  return out;
}

void print_text(const DelayFigure& figure) {
  fmt::print("Thesis figure {}: {}\n\n", figure.figure + 3, figure.title);
  Table table;
  std::vector<std::string> heading{""};
  heading.insert(heading.end(), figure.columns.begin(), figure.columns.end());
  table.heading(std::move(heading));
  for (const FigureNumber& q : figure.quantities) {
    std::vector<std::string> row{fmt::format("{} [{}]", q.name, q.unit)};
    for (const auto& value : q.values) row.push_back(value ? rounded(*value) : "-");
    table.row(std::move(row));
  }
  table.print(stdout);
}

}  // namespace

void tell(const ReproduceOptions& options, const DelayFigure& figure) {
  if (options.common.json) fmt::print("{}\n", text_of_json(to_json(figure)));
  else print_text(figure);
}

Outcome finish(const ReproduceOptions& options, const DelayFigure& figure) {
  tell(options, figure);
  return write_figure(options, figure.plot, {{figure.figure + std::string(".csv"), figure.table}});
}

}  // namespace tactus::cli
