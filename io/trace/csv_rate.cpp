// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/csv_rate.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/trace/csv_time.h>
#include <tactus/trace/messages.h>

namespace tactus {
namespace {

constexpr double kOnGrid = 0.1;                         // [ticks]
constexpr double kLowestRate = 10, kHighestRate = 5e4;  // [1/s] that are believed without a word of the unit
constexpr double kTogether = 0.1;                       // of the mean gap: rows that are so close are of a group
constexpr double kAlike = 1e-3;                         // of the mean gap: times are equal
constexpr double kPause = 20;                           // gaps
constexpr double kFarthest = 0.5;                       // [s] groups of rows whose times differ: what is farther apart are pauses

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// 1000 for 998.7: the roundest number as near as `tolerance` (a fraction), else the next whole one.
std::uint32_t round_rate(double rate, double tolerance) {
  for (int digits = static_cast<int>(std::log10(std::max(rate, 1.0))); digits >= 0; --digits) {
    const double step = std::pow(10, digits);
    const double rounded = std::round(rate / step) * step;
    if (std::abs(rounded - rate) <= tolerance * rate && rounded >= 1) return static_cast<std::uint32_t>(rounded);
  }
  return static_cast<std::uint32_t>(std::round(rate));
}

/// From a row to the next of its object and segment.
struct Gap {
  const CsvRow *from, *to;
  double seconds;
};

class CsvRateEstimator {
 public:
  CsvRateEstimator(std::span<const CsvRow> rows, const CsvMapping& mapping, CsvNamedPlan& plan);
  CsvResult<CsvRate> find();

 private:
  bool find_groups();
  bool are_samples() const;
  void count_groups();
  CsvResult<void> take_groups();
  CsvResult<void> take_gaps();
  CsvResult<void> ask(double exact, double median) const;
  bool is_off(double rate) const;
  tl::unexpected<Diagnostic> refuse(Errc code, RuleName rule, std::string detail, std::string remedy) const {
    return tl::unexpected(Diagnostic{
        .error = fail(code, rule).value(), .line = first_->line, .detail = std::move(detail), .remedy = std::move(remedy)});
  }

  const CsvMapping& mapping_;
  CsvNamedPlan& plan_;
  const CsvRow* first_;
  std::vector<const CsvRow*> rows_;  // of the object that has most
  std::vector<Gap> gaps_;            // 0 or longer
  double mean_ = 0, pause_ = 0;      // [s] gaps without pauses; what is a pause between groups
  double uncertain_ = 0;             // fraction of the rate of groups
  CsvRate rate_;
};

CsvRateEstimator::CsvRateEstimator(std::span<const CsvRow> rows, const CsvMapping& mapping, CsvNamedPlan& plan)
    : mapping_(mapping), plan_(plan), first_(&rows[0]) {
  rate_.tick_rate = mapping.tick_rate;
  std::map<std::uint32_t, std::size_t> counts;  // of the objects of a long table
  for (const CsvRow& row : rows) ++counts[row.values[0].channel];
  const auto busiest = std::ranges::max_element(counts, {}, [](const auto& c) { return c.second; })->first;
  for (const CsvRow& row : rows) {
    if (row.values[0].channel != busiest) continue;
    if (!rows_.empty() && rows_.back()->segment == row.segment)
      gaps_.push_back({rows_.back(), &row, static_cast<double>(row.time - rows_.back()->time) / 1e9});
    rows_.push_back(&row);
  }
}

/// Whether rows that are close in time are neither copies nor as close in truth: then an object moves on as far within groups as from
/// one to the next.
bool CsvRateEstimator::are_samples() const {
  std::size_t close = 0, close_differ = 0, far = 0, far_differ = 0;
  std::vector<double> close_steps, far_steps, close_gaps, far_gaps;  // [m], [s]
  for (const Gap& gap : gaps_) {
    if (gap.seconds > pause_) continue;
    const bool is_close = gap.seconds < kTogether * mean_;
    const bool differs = !std::equal(gap.from->values.begin(), gap.from->values.end(), gap.to->values.begin(),
                                     gap.to->values.end(), [](const CsvValue& a, const CsvValue& b) {
                                       return a.is_there == b.is_there && a.sample.pose.position == b.sample.pose.position &&
                                              a.sample.pose.rotation == b.sample.pose.rotation;
                                     });
    const Vec3 step = gap.to->values[0].sample.pose.position - gap.from->values[0].sample.pose.position;
    ++(is_close ? close : far);
    if (differs) ++(is_close ? close_differ : far_differ);
    (is_close ? close_steps : far_steps).push_back(norm(step));
    (is_close ? close_gaps : far_gaps).push_back(gap.seconds);
  }
  if (10 * close_differ < close && 10 * far_differ >= far) return false;  // copies
  const double close_gap = median_of(close_gaps), close_step = median_of(close_steps);
  if (close_gap < kAlike * mean_) return true;
  const bool moves_evenly = close_step > 0 ? median_of(far_steps) <= 3 * close_step : close_gap < 0.02 * mean_;
  return moves_evenly && median_of(far_gaps) <= kFarthest;
}

/// Rows of whole groups over their time: the first and the last of a run may be cut.
void CsvRateEstimator::count_groups() {
  struct Group {
    std::int64_t time;
    std::size_t first, rows;
  };
  double rows = 0, groups = 0, length = 0, largest = 0, smallest = 1e9, longest = 0, shortest = 1e18;
  std::vector<Group> run;
  std::optional<std::vector<Group>> first_run;
  const auto end_run = [&] {
    const std::size_t n = run.size();
    for (std::size_t i = 1; i + 1 < n; ++i) {
      const auto size = static_cast<double>(run[i].rows), apart = static_cast<double>(run[i + 1].time - run[i].time);
      rows += size, ++groups;
      largest = std::max(largest, size), smallest = std::min(smallest, size);
      longest = std::max(longest, apart), shortest = std::min(shortest, apart);
    }
    if (n >= 3) length += static_cast<double>(run[n - 1].time - run[1].time + run[n - 2].time - run[0].time) / 2;
    if (n >= 3 && !first_run && run[0].first == 0) first_run = run;
    run.clear();
  };
  std::size_t gap = 0;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const bool follows = i > 0 && gap < gaps_.size() && gaps_[gap].to == rows_[i];
    const double seconds = follows ? gaps_[gap++].seconds : 1e9;
    if (seconds > pause_) end_run();
    if (run.empty() || seconds >= kTogether * mean_) run.push_back({rows_[i]->time, i, 0});
    ++run.back().rows;
  }
  end_run();
  if (groups == 0 || length == 0) return;
  rate_.period = length / rows;
  rate_.apart = length / groups;
  rate_.size = rows / groups;
  const bool are_equal = largest == smallest && longest - shortest < 0.01 * rate_.apart;
  uncertain_ = are_equal ? 5e-4 : rate_.size / rows + 5e-4;
  if (!first_run || plan_.object) return;
  std::vector<double> leads;
  for (const Group& group : *first_run)
    leads.push_back(static_cast<double>(group.time - first_run->front().time) - rate_.period * static_cast<double>(group.first));
  rate_.lead = median_of(leads);
}

bool CsvRateEstimator::find_groups() {
  if (!mapping_.resample || rows_.size() < 8) return false;
  double all = 0, length = 0, count = 0;
  for (const Gap& gap : gaps_) all += gap.seconds / static_cast<double>(gaps_.size());
  std::vector<double> far;
  for (const Gap& gap : gaps_)
    if (gap.seconds > 0 && gap.seconds >= kTogether * all) far.push_back(gap.seconds);
  pause_ = kPause * median_of(std::move(far));
  for (const Gap& gap : gaps_)
    if (gap.seconds <= pause_) length += gap.seconds, ++count;
  if (length == 0) return false;
  mean_ = length / count;
  const auto fraction_below = [&](double seconds) {
    const auto below = std::ranges::count_if(gaps_, [&](const Gap& gap) { return gap.seconds < seconds; });
    return static_cast<double>(below) / static_cast<double>(gaps_.size());
  };
  if (fraction_below(kAlike * mean_) < 0.03 && fraction_below(kTogether * mean_) < 0.2) return false;  // a few times that repeat
  if (!are_samples()) return false;
  count_groups();
  return rate_.period > 0;
}

CsvResult<void> CsvRateEstimator::take_groups() {
  const double exact = 1e9 / rate_.period;
  if (!(exact <= 1.5 * kMaxTickRate)) return refuse(Errc::invalid_argument, "R-CSV-7", "", "Give --time-unit, or --tick-rate.");
  if (rate_.tick_rate == 0) {
    TACTUS_CHECK(ask(exact, rate_.period / 1e9));
    rate_.tick_rate = std::max(1u, round_rate(exact, uncertain_));
  }
  if (std::abs(rate_.tick_rate - exact) <= uncertain_ * exact) rate_.period = 1e9 / rate_.tick_rate;
  const double off = rate_.period * rate_.tick_rate / 1e9;
  rate_.is_off_grid = std::abs(off - std::round(off)) > 1e-6;
  const std::string what = "several rows share a time or come in groups, of " + number_text(rate_.size, "%.4g") + " rows each " +
                           number_text(rate_.apart / 1e9, "%.3g") + " s";
  if (mapping_.strict) return refuse(Errc::invalid, "R-CSV-5", what, "Do not give --strict: they are then spread evenly.");
  plan_.notes.add("", what + ": spread evenly, " + number_text(1e9 / rate_.period, "%.6g") + " rows per second");
  return {};
}

CsvResult<void> CsvRateEstimator::ask(double exact, double median) const {
  const std::string apart = "rows " + number_text(median) + " s apart, " + number_text(exact, "%.4g") + " Hz";
  const std::string rate = std::to_string(std::max(1u, round_rate(exact, 5e-4)));
  const std::string counts =
      median == std::round(median) ? "; --time-unit tick and --tick-rate HZ if they count ticks or frames" : "";
  if (exact < kLowestRate && !plan_.time_is_stated)
    return refuse(Errc::invalid, "R-CSV-11", apart,
                  "Say --time-unit ms (us, ns) if the times are no seconds, --time-unit s or --tick-rate " + rate +
                      " if they are" + counts + ".");
  if (exact > kHighestRate && !plan_.time_is_stated)
    return refuse(
        Errc::invalid, "R-CSV-11", apart,
        "Say --time-unit day (min, h) if the times are no seconds, --time-unit s or --tick-rate " + rate + " if they are.");
  if (exact < 0.99)
    return refuse(Errc::invalid_argument, "R-CSV-7", number_text(exact, "%.4g") + " Hz",
                  "Give --tick-rate HZ: it is 1 at least.");
  return {};
}

bool CsvRateEstimator::is_off(double rate) const {
  const CsvRow* start = nullptr;
  return std::ranges::any_of(rows_, [&](const CsvRow* row) {
    if (start == nullptr || row->segment != start->segment) start = row;
    const double at = static_cast<double>(row->time - start->time) / 1e9 * rate;
    return std::abs(at - std::round(at)) > kOnGrid;
  });
}

/// Two estimates: the median of the gaps, and the count over the length without pauses.
CsvResult<void> CsvRateEstimator::take_gaps() {
  std::vector<double> gaps;
  double length = 0, count = 0;
  for (const Gap& gap : gaps_)
    if (gap.seconds > 0) gaps.push_back(gap.seconds), length += gap.seconds;
  if (gaps.empty() && mapping_.tick_rate == 0)
    return refuse(Errc::invalid_argument, "R-CSV-7", rows_.size() > 1 ? "all rows have one time" : "",
                  "Give --tick-rate HZ, without --time where times do not differ.");
  const double median = gaps.empty() ? 1.0 / mapping_.tick_rate : median_of(gaps);
  const double pause = kPause * length / static_cast<double>(std::max<std::size_t>(gaps.size(), 1));
  length = 0;
  for (const double gap : gaps)
    if (gap <= pause) length += gap, ++count;
  const double by_median = 1 / median, by_count = gaps.empty() ? by_median : count / length;
  if (!(by_median <= 4e9) || !(by_count <= 1.5 * kMaxTickRate))
    return refuse(Errc::invalid_argument, "R-CSV-7", "rows " + number_text(median) + " s apart",
                  "Give --time-unit (day for Excel's and MATLAB's dates), or --tick-rate.");
  if (mapping_.tick_rate == 0) {
    const double rounded = std::max(1.0, std::round(by_median));
    const bool takes_median = rounded <= kMaxTickRate && !is_off(rounded) && by_count >= 0.5 * rounded;
    const double exact = takes_median ? rounded : by_count;
    rate_.tick_rate =
        takes_median ? static_cast<std::uint32_t>(rounded) : std::max(1u, round_rate(exact, 1.0 / std::max(count, 1.0) + 5e-4));
    if (std::abs(by_median - by_count) > 0.1 * by_count && !gaps.empty())
      plan_.notes.add("", "the median gap says " + number_text(by_median, "%.4g") + " Hz, the number of rows over their time " +
                              number_text(by_count, "%.4g") + " Hz: " + std::to_string(rate_.tick_rate) +
                              " Hz is taken; --tick-rate says otherwise");
    TACTUS_CHECK(ask(exact, median));
  }
  rate_.is_off_grid = mapping_.resample && is_off(rate_.tick_rate);
  return {};
}

CsvResult<CsvRate> CsvRateEstimator::find() {
  if (find_groups()) {
    TACTUS_CHECK(take_groups());
  } else {
    TACTUS_CHECK(take_gaps());
  }
  if (rate_.tick_rate > kMaxTickRate)
    return refuse(Errc::invalid_argument, "R-CSV-7", "", "Give --tick-rate HZ, at most 1000000.");
  if (rate_.is_off_grid)
    plan_.notes.add(
        "", "times lie on no grid: resampled at " + std::to_string(rate_.tick_rate) + " Hz (--no-resample refuses such tables)");
  return rate_;
}

}  // namespace

CsvResult<CsvRate> estimate_rate(std::span<const CsvRow> rows, const CsvMapping& mapping, CsvNamedPlan& plan) {
  return CsvRateEstimator(rows, mapping, plan).find();
}

std::int64_t EvenTimes::time_of(const CsvRow& row, std::size_t object) {
  const auto [found, is_new] = last_.try_emplace(object);
  Last& last = found->second;
  if (is_new || last.segment != row.segment) {
    last = {.segment = row.segment, .first = row.time, .time = row.time, .even = std::exchange(rate_.lead, 0), .correction = 0};
    return row.time + std::llround(last.even);
  }
  const auto gap = static_cast<double>(row.time - last.time), now = static_cast<double>(row.time - last.first);
  last.time = row.time;
  const double even = last.even + rate_.period + last.correction;
  const bool is_after_pause = gap > 3 * rate_.apart + rate_.period && now > even;
  last.even = is_after_pause ? now : even;
  if (gap < kTogether * rate_.period) return last.first + std::llround(last.even);
  // a group begins: what the even times are off by more than a group is made good over the next 32
  const double off = now - last.even;
  last.correction = std::abs(off) <= rate_.apart ? 0 : std::clamp(off / (32 * rate_.size), -0.5 * rate_.period, rate_.period);
  return last.first + std::llround(last.even);
}

}  // namespace tactus
