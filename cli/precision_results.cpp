// SPDX-License-Identifier: Apache-2.0
#include "cli/precision_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/cmd_bench.h"
#include "cli/json_parts.h"

namespace tactus::cli {
namespace fs = std::filesystem;
namespace {

constexpr const char* kTimeFile = "time.csv";
constexpr const char* kSpaceFile = "space.csv";
constexpr const char* kContextFile = "context.json";
constexpr const char* kTimeHeading =
    "scene,method,steps_per_sample,step_s,displacement_end_error,displacement_error,velocity_error,force_error,energy_error,"
    "weight_error,push_error,seconds_per_second,setup_s,runs,newton_per_step,solver_per_step,unconverged_steps,taken,remark";
constexpr const char* kSpaceHeading =
    "scene,poisson,refinement,vertices,tets,deflection_m_per_n,solve_s,quadratic_m_per_n,step_s,seconds_per_second,"
    "transient_m";

/// In the order of the heading.
constexpr double sim::study::Errors::*kErrors[] = {&sim::study::Errors::displacement_end,
                                                   &sim::study::Errors::displacement,
                                                   &sim::study::Errors::velocity,
                                                   &sim::study::Errors::force,
                                                   &sim::study::Errors::energy,
                                                   &sim::study::Errors::weight,
                                                   &sim::study::Errors::push};

std::string number(double value) { return std::isfinite(value) ? fmt::format("{:.7g}", value) : ""; }

/// As RFC 4180 wants text with commas; the text holds no quotes itself.
std::string quoted(const std::string& text) { return text.find(',') == std::string::npos ? text : '"' + text + '"'; }

std::string line_of(const TimeRow& row) {
  const sim::study::PrecisionPoint& p = row.point;
  std::string out = fmt::format("{},{},{},{}", row.scene, p.method, p.steps_per_sample, number(p.step));
  for (const double sim::study::Errors::*error : kErrors) out += ',' + number(p.errors.*error);
  return out + fmt::format(",{},{},{},{},{},{},{},{}", number(p.seconds_per_second), number(p.setup_seconds), p.runs,
                           number(p.newton_per_step), number(p.solver_per_step), p.unconverged_steps, quoted(p.taken),
                           quoted(p.remark));
}

std::string line_of(const SpaceRow& row) {
  const sim::study::SpacePoint& p = row.point;
  std::string transient;
  for (const double value : p.deflection) transient += (transient.empty() ? "" : " ") + number(value);
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{}", row.scene, number(p.poisson), p.refinement, p.vertices, p.tets,
                     number(p.at_rest.deflection), number(p.at_rest.seconds), number(p.quadratic_deflection), number(p.step),
                     number(p.seconds_per_second), transient);
}

/// The cells of a line one after the other; what is no number makes the whole line bad.
class Cells {
 public:
  explicit Cells(const std::string& line) : in_(line) {}

  std::string text() {
    std::string cell;
    if (in_.peek() == '"') {
      in_.get();
      if (!std::getline(in_, cell, '"') || (in_.get() != ',' && !in_.eof())) good_ = false;
    } else if (!std::getline(in_, cell, ',') && !in_.eof()) {
      good_ = false;
    }
    return cell;
  }
  template <class Number>
  Number get() {
    Number value{};
    const std::string cell = text();
    if (cell.empty() && std::is_floating_point_v<Number>) return std::numeric_limits<Number>::quiet_NaN();
    const auto result = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (result.ec != std::errc{} || result.ptr != cell.data() + cell.size()) good_ = false;
    return value;
  }
  bool is_good() const { return good_; }

 private:
  std::istringstream in_;
  bool good_ = true;
};

std::optional<TimeRow> time_row(const std::string& line) {
  Cells cells(line);
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

std::optional<SpaceRow> space_row(const std::string& line) {
  Cells cells(line);
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

/// Rows behind the heading. A last line without its end was being written when the program was stopped: it is left out.
template <class Row, class Parse>
Outcome read_rows(const std::string& path, const std::string& heading, std::vector<Row>& rows, Parse&& parse) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return {};
  TACTUS_TRY(auto text, read_file(path));
  const std::size_t whole = text.rfind('\n') + 1;
  if (whole != text.size()) {
    std::error_code error;
    fs::resize_file(path, whole, error);
    if (error) return refuse(path + ": " + error.message(), "Check that you may write it.");
    text.resize(whole);
  }
  std::istringstream in(text);
  std::string line;
  for (int number_of_line = 1; std::getline(in, line); ++number_of_line) {
    if (number_of_line == 1 && line == heading) continue;
    auto row = parse(line);
    if (number_of_line == 1 || !row) {
      return refuse(fmt::format("{}, line {}: not a row of this report", path, number_of_line),
                    "Remove the line, or give -f to start afresh.");
    }
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
    return out;
  }
  TACTUS_TRY(const auto found, read_file(file));
  if (found != wanted) {
    return refuse(file + ": this folder holds figures of another machine, build or extent",
                  "Give another folder, or -f to start afresh in this one.");
  }
  TACTUS_CHECK(out.read());
  return out;
}

Outcome PrecisionResults::read() {
  TACTUS_CHECK(read_rows(path(kTimeFile), kTimeHeading, times_, time_row));
  return read_rows(path(kSpaceFile), kSpaceHeading, spaces_, space_row);
}

Outcome PrecisionResults::append(const std::string& file, const std::string& heading, const std::string& line) const {
  std::error_code ignored;
  if (fs::is_symlink(file, ignored)) return refuse(file + ": is a link", "Remove it: what it leads to would be written to.");
  const bool is_new = !fs::exists(file, ignored);
  std::ofstream out(file, std::ios::app);
  if (is_new) out << heading << '\n';
  out << line << '\n' << std::flush;
  if (!out) return refuse_io(file, "cannot be written", errno);
  return {};
}

Outcome PrecisionResults::add(TimeRow row) {
  // As read back, so that a report made now and one made later from the file are the same.
  const std::string line = line_of(row);
  times_.push_back(*time_row(line));
  return append(path(kTimeFile), kTimeHeading, line);
}

Outcome PrecisionResults::add(SpaceRow row) {
  const std::string line = line_of(row);
  spaces_.push_back(*space_row(line));
  return append(path(kSpaceFile), kSpaceHeading, line);
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
