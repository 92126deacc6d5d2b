// SPDX-License-Identifier: Apache-2.0
/// Rows at their times to frames at ticks: order, rate, missing samples and resampling, in bounded memory. Internal to the library.
///
/// Rows wait in a window until they are in order. The first of them show the rate and whether times lie on its grid. On the grid each row is a
/// tick; off it, ticks lie between rows. Either way a channel that has no sample at a tick gets one on the line (the arc) between its
/// neighbours, if they are no farther apart than the gap. A tick of which no channel knows anything is left out.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <tactus/trace/csv_rate.h>
#include <tactus/trace/csv_rows.h>
#include <tactus/trace/input_budget.h>
#include <tactus/trace/sample_track.h>

namespace tactus {

class CsvTimeline {
 public:
  CsvTimeline(const CsvMapping& mapping, CsvNamedPlan& plan, const CsvRows& rows, std::string out_path);
  CsvResult<void> add(CsvRow row);
  CsvResult<CsvImport> finish();
  bool has_output() const noexcept { return writer_.has_value(); }
  void expect_objects(std::vector<std::string> names) { long_objects_ = std::move(names); }  ///< of a long table, all of them

 private:
  struct Instant {  // [ticks] since the segment began
    std::int64_t tick = 0;
    double off = 0;  // -0.5 .. 0.5
    double since(const Instant& other) const noexcept { return static_cast<double>(tick - other.tick) + (off - other.off); }
    friend double since(const Instant& time, const Instant& other) noexcept { return time.since(other); }
  };

  void mark_restart(CsvRow& row);
  std::string restart_suffix() const { return restarts_ == 0 ? "" : '#' + std::to_string(restarts_); }
  Diagnostic out_of_order(const CsvRow& row) const;
  CsvResult<void> release();
  CsvResult<void> deliver(CsvRow row);
  CsvResult<void> start();
  CsvResult<void> find_rate();
  CsvResult<void> take_contacts();
  CsvResult<void> begin_segment(const CsvRow& row);
  CsvResult<void> end_segment();
  CsvResult<void> ask_for_ticks(const CsvRow& row, const Instant& at);
  CsvResult<void> emit(bool is_end);
  bool is_ready(std::int64_t tick) const;
  bool sample_at(std::size_t channel, std::int64_t tick, RigidSample& out);
  CsvResult<void> write(std::int64_t tick);
  void derive_motion(TraceFrame& frame, bool begins) const;
  void check_angular_velocity(const TraceFrame& frame);
  Instant instant_of(std::int64_t time) const noexcept;
  Diagnostic mistake(Errc code, RuleName rule, std::uint64_t line, std::string detail, std::string remedy = {}) const;

  const CsvMapping& mapping_;
  CsvNamedPlan& plan_;
  const CsvRows& rows_;
  std::string out_path_;
  std::vector<std::string> long_objects_;
  std::deque<CsvRow> window_;      // in order
  std::vector<CsvRow> waiting_;    // until the rate is known
  std::optional<EvenTimes> even_;  // of rows in groups
  ContactDeclarations contacts_;
  std::optional<TraceWriter> writer_;
  std::optional<std::int64_t> released_;  // [ns] time of the last row that left the window
  std::uint64_t released_line_ = 0, restarts_ = 0, falls_ = 0;
  std::optional<std::int64_t> last_time_;  // of the row before
  std::string segment_;
  bool has_segment_ = false, resamples_ = false, begins_ = true, ended_ = false;
  std::int64_t segment_time_ = 0, base_ = 0, shift_ = 0, next_tick_ = 0, row_number_ = 0;
  double gap_ = 0;  // [ticks]
  Instant now_;     // of the newest row
  std::vector<SampleTrack<Instant>> channels_;
  std::deque<std::int64_t> ticks_;  // asked for, of this segment
  TraceFrame frame_, before_;
  InputBudget budget_;
  std::uint64_t made_ = 0, left_out_ = 0, rested_ = 0, repeated_ = 0;
  double largest_gap_ = 0;
  CsvImport done_;
};

}  // namespace tactus
