// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/precision_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/laboratory/cmd_bench.h"
#include "cli/report/json_parts.h"

namespace tactus::cli {
namespace fs = std::filesystem;
namespace {

constexpr const char* kTimeFile = "time.csv";
constexpr const char* kSpaceFile = "space.csv";
constexpr const char* kContextFile = "context.json";
using Row = GrowingTable::Row;

const Row& time_columns() {
  static const Row columns{"scene",
                           "method",
                           "steps_per_sample",
                           "step_s",
                           "displacement_end_error",
                           "displacement_error",
                           "velocity_error",
                           "force_error",
                           "energy_error",
                           "weight_error",
                           "push_error",
                           "seconds_per_second",
                           "setup_s",
                           "runs",
                           "newton_per_step",
                           "solver_per_step",
                           "unconverged_steps",
                           "taken",
                           "remark"};
  return columns;
}

const Row& space_columns() {
  static const Row columns{"scene",   "poisson",           "refinement", "vertices",           "tets",       "deflection_m_per_n",
                           "solve_s", "quadratic_m_per_n", "step_s",     "seconds_per_second", "transient_m"};
  return columns;
}

/// In the order of the columns.
constexpr double sim::study::Errors::*kErrors[] = {&sim::study::Errors::displacement_end,
                                                   &sim::study::Errors::displacement,
                                                   &sim::study::Errors::velocity,
                                                   &sim::study::Errors::force,
                                                   &sim::study::Errors::energy,
                                                   &sim::study::Errors::weight,
                                                   &sim::study::Errors::push};

std::string number(double value) { return std::isfinite(value) ? fmt::format("{:.7g}", value) : ""; }

Row cells_of(const TimeRow& row) {
  const sim::study::PrecisionPoint& p = row.point;
  Row out{row.scene, p.method, fmt::to_string(p.steps_per_sample), number(p.step)};
  for (const double sim::study::Errors::*error : kErrors) out.push_back(number(p.errors.*error));
  out.insert(out.end(), {number(p.seconds_per_second), number(p.setup_seconds), fmt::to_string(p.runs), number(p.newton_per_step),
                         number(p.solver_per_step), fmt::to_string(p.unconverged_steps), p.taken, p.remark});
  return out;
}

Row cells_of(const SpaceRow& row) {
  const sim::study::SpacePoint& p = row.point;
  std::string transient;
  for (const double value : p.deflection) transient += (transient.empty() ? "" : " ") + number(value);
  return {row.scene,
          number(p.poisson),
          fmt::to_string(p.refinement),
          fmt::to_string(p.vertices),
          fmt::to_string(p.tets),
          number(p.at_rest.deflection),
          number(p.at_rest.seconds),
          number(p.quadratic_deflection),
          number(p.step),
          number(p.seconds_per_second),
          transient};
}

/// The cells of a row one after the other; what is no number makes the whole row bad.
class Cells {
 public:
  explicit Cells(const Row& row) : next_(row.begin()) {}

  const std::string& text() { return *next_++; }
  template <class Number>
  Number get() {
    Number value{};
    const std::string& cell = text();
    if (cell.empty() && std::is_floating_point_v<Number>) return std::numeric_limits<Number>::quiet_NaN();
    const auto result = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (result.ec != std::errc{} || result.ptr != cell.data() + cell.size()) good_ = false;
    return value;
  }
  bool is_good() const { return good_; }

 private:
  Row::const_iterator next_;
  bool good_ = true;
};

std::optional<TimeRow> time_row(const Row& in) {
  Cells cells(in);
  TimeRow row;
  sim::study::PrecisionPoint& p = row.point;
  row.scene = cells.text();
  p.method = cells.text();
  p.steps_per_sample = cells.get<int>();
  p.step = cells.get<double>();
  for (double sim::study::Errors::*error : kErrors) p.errors.*error = cells.get<double>();
  p.seconds_per_second = cells.get<double>();
  p.setup_seconds = cells.get<double>();
  p.runs = cells.get<int>();
  p.newton_per_step = cells.get<double>();
  p.solver_per_step = cells.get<double>();
  p.unconverged_steps = cells.get<int>();
  p.taken = cells.text();
  p.remark = cells.text();
  return cells.is_good() ? std::optional(row) : std::nullopt;
}

std::optional<SpaceRow> space_row(const Row& in) {
  Cells cells(in);
  SpaceRow row;
  sim::study::SpacePoint& p = row.point;
  row.scene = cells.text();
  p.poisson = cells.get<double>();
  p.refinement = cells.get<int>();
  p.vertices = cells.get<std::size_t>();
  p.tets = cells.get<std::size_t>();
  p.at_rest.deflection = cells.get<double>();
  p.at_rest.seconds = cells.get<double>();
  p.quadratic_deflection = cells.get<double>();
  p.step = cells.get<double>();
  p.seconds_per_second = cells.get<double>();
  std::istringstream transient(cells.text());
  for (double value = 0; transient >> value;) p.deflection.push_back(value);
  return cells.is_good() ? std::optional(row) : std::nullopt;
}

template <class Found>
Outcome take_up(const std::string& path, const Row& columns, std::optional<GrowingTable>& table, std::vector<Found>& rows,
                std::optional<Found> (*parse)(const Row&)) {
  TACTUS_TRY(table, GrowingTable::open(path, columns));
  for (const Row& cells : table->rows()) {
    auto row = parse(cells);
    if (!row) return table->refuse_row(rows.size());
    rows.push_back(*std::move(row));
  }
  return {};
}

}  // namespace

tl::expected<PrecisionResults, Failure> PrecisionResults::open(std::string folder, Context context,
                                                               OutputFile::Existing existing) {
  TACTUS_CHECK(make_folder(folder));
  PrecisionResults out(std::move(folder), std::move(context));
  const std::string wanted = text_of_json(nlohmann::ordered_json(out.context_)) + "\n", file = out.path(kContextFile);
  if (existing == OutputFile::Existing::replace) {
    std::error_code absent;
    for (const char* name : {kTimeFile, kSpaceFile, kContextFile}) fs::remove(out.path(name), absent);
  }
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    TACTUS_CHECK(write_file(file, wanted, OutputFile::Existing::keep));
  } else {
    TACTUS_TRY(const auto found, read_file(file));
    if (found != wanted) {
      return refuse(file + ": this folder holds results of another machine, build or extent",
                    "Give another folder, or -f to replace the results in this one.");
    }
  }
  TACTUS_CHECK(out.read());
  return out;
}

Outcome PrecisionResults::read() {
  TACTUS_CHECK(take_up(path(kTimeFile), time_columns(), time_table_, times_, time_row));
  return take_up(path(kSpaceFile), space_columns(), space_table_, spaces_, space_row);
}

// Rows are kept as they are read back, so that a report made now and one made later from the file are the same.
Outcome PrecisionResults::add(const TimeRow& row) {
  Row cells = cells_of(row);
  times_.push_back(*time_row(cells));
  return time_table_->add(std::move(cells));
}

Outcome PrecisionResults::add(const SpaceRow& row) {
  Row cells = cells_of(row);
  spaces_.push_back(*space_row(cells));
  return space_table_->add(std::move(cells));
}

const TimeRow* PrecisionResults::find(const std::string& scene, const std::string& method, int steps_per_sample) const {
  const auto row = std::find_if(times_.begin(), times_.end(), [&](const TimeRow& r) {
    return r.scene == scene && r.point.method == method && r.point.steps_per_sample == steps_per_sample;
  });
  return row == times_.end() ? nullptr : &*row;
}

const SpaceRow* PrecisionResults::find(const std::string& scene, const sim::study::SpaceJob& job) const {
  const auto row = std::find_if(spaces_.begin(), spaces_.end(), [&](const SpaceRow& r) {
    return r.scene == scene && r.point.refinement == job.refinement && r.point.poisson == job.poisson;
  });
  return row == spaces_.end() ? nullptr : &*row;
}

}  // namespace tactus::cli
