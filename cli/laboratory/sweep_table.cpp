// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/sweep_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <tactus/trace/csv_reader.h>

namespace tactus::cli {
namespace {

/// "0.05", "2.5%", "5mm,4deg": the number that a cell begins with.
double leading_number(const std::string& cell) {
  double value = 0;
  const auto end = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return end.ec == std::errc() ? value : std::numeric_limits<double>::quiet_NaN();
}

void add_repetition(SweepGroup& group, const SweepPlan& plan, const SweepResults::Row& row) {
  const auto columns = plan.all_columns();
  if (group.texts.empty()) {
    group.texts = row;
    group.texts.resize(columns.size());
    group.numbers.resize(columns.size());
  }
  for (std::size_t i = 0; i < row.size(); ++i) group.numbers[i].push_back(leading_number(row[i]));
  const auto of_name = [&](const std::string& name) {
    return group.numbers[static_cast<std::size_t>(std::ranges::find(columns, name) - columns.begin())].back();
  };
  for (std::size_t i = 0; i < plan.derived.size(); ++i)
    group.numbers[row.size() + i].push_back(plan.derived[i].formula.value(of_name));
}

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.9g}", value) : ""; }

std::string line_of(const std::vector<std::string>& cells) {
  std::string out;
  for (const std::string& text : cells) out += (out.empty() ? "" : ",") + csv_field(text);
  return out + '\n';
}

/// Columns of table.csv that are numbers, as indices.
std::vector<std::size_t> tabled(const SweepPlan& plan) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < plan.measures.size(); ++i) out.push_back(plan.parameters.size() + i);
  const std::size_t derived = plan.all_columns().size() - plan.derived.size();
  for (std::size_t i = 0; i < plan.derived.size(); ++i)
    if (!plan.derived[i].from_times) out.push_back(derived + i);
  return out;
}

}  // namespace

Spread spread_of(std::vector<double> numbers) {
  std::erase_if(numbers, [](double value) { return !std::isfinite(value); });
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (numbers.empty()) return {kNone, kNone, kNone};
  std::ranges::sort(numbers);
  const std::size_t half = numbers.size() / 2;
  const double median = numbers.size() % 2 == 1 ? numbers[half] : (numbers[half - 1] + numbers[half]) / 2;
  return {numbers.front(), median, numbers.back()};
}

std::vector<SweepGroup> groups_of(const SweepPlan& plan, const SweepResults& results) {
  std::vector<SweepGroup> out;
  for (std::size_t first = 0; first < plan.points(); first += plan.repetitions()) {
    SweepGroup group;
    for (std::size_t i = 0; i < plan.repetitions(); ++i)
      if (const auto row = results.row(plan, first + i); !row.empty()) add_repetition(group, plan, row);
    if (!group.texts.empty()) out.push_back(std::move(group));
  }
  return out;
}

tl::expected<std::vector<std::string>, Failure> write_table(const SweepPlan& plan, const SweepResults& results) {
  if (!plan.repeats && plan.derived.empty()) return std::vector<std::string>();
  const auto columns = plan.all_columns();
  const auto numbers = tabled(plan);
  const std::size_t parameters = plan.parameters.size() - (plan.repeats ? 1 : 0);
  std::vector<std::string> cells(columns.begin(), columns.begin() + static_cast<std::ptrdiff_t>(parameters));
  if (plan.repeats) cells.emplace_back("repetitions");
  for (const std::size_t i : numbers) {
    if (!plan.repeats) cells.push_back(columns[i]);
    else
      for (const char* part : {"_min", "_median", "_max"}) cells.push_back(columns[i] + part);
  }
  std::string text = line_of(cells);
  for (const SweepGroup& group : groups_of(plan, results)) {
    cells.assign(group.texts.begin(), group.texts.begin() + static_cast<std::ptrdiff_t>(parameters));
    if (plan.repeats) cells.push_back(fmt::to_string(group.numbers.front().size()));
    for (const std::size_t i : numbers) {
      const Spread spread = spread_of(group.numbers[i]);
      const std::string median = std::isfinite(spread.median) ? cell(spread.median) : group.texts[i];
      if (plan.repeats) cells.insert(cells.end(), {cell(spread.min), median, cell(spread.max)});
      else cells.push_back(median);
    }
    text += line_of(cells);
  }
  const std::string path = results.folder() + "/table.csv";
  TACTUS_CHECK(write_file(path, text, OutputFile::Existing::replace));
  return std::vector{path};
}

}  // namespace tactus::cli
