// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/ros_clock.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include <tactus/trace/messages.h>

namespace tactus {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kStep = 10'000'000;  // [ns] what one channel falls back by is a step of the clock, not a crossing
constexpr std::int64_t kLeap =
    30'000'000 * kSecond;  // nobody records nothing for a year: the clock was set, as of a computer that began in 1970
constexpr std::int64_t kOtherClock = kSecond;              // stamps that are so far off are of another clock
constexpr std::int64_t kMostLagRange = 5 * kSecond;        // of usable stamps
constexpr std::int64_t kFar = 60 * kSecond;                // a header stamp from its log time
constexpr std::int64_t kFarthest = std::int64_t{1} << 62;  // [ns] so that sums of times do not overflow
constexpr double kBurst = 1.5;                             // mean gap over median gap

/// Eighths of octaves: 8 bins between a power of two and the next.
std::uint16_t bin_of(std::uint64_t gap) noexcept {
  const auto width = static_cast<int>(std::bit_width(gap));
  if (width <= 4) return static_cast<std::uint16_t>(gap);
  return static_cast<std::uint16_t>(8 * width + static_cast<int>(gap >> (width - 4) & 7));
}

}  // namespace

// ==== gaps ====

void GapStatistics::add(std::uint64_t time) {
  if (count_++ == 0) {
    first_ = last_ = time;
    return;
  }
  if (time < last_) {
    ++backward_;
    farthest_back_ = std::max(farthest_back_, last_ - time);
    return;
  }
  const std::uint64_t gap = time - last_;
  if (gap == 0) ++equal_;
  largest_ = std::max(largest_, gap);
  Bin& bin = bins_[bin_of(gap)];
  ++bin.count;
  bin.sum += 1e-9 * static_cast<double>(gap);
  last_ = time;
}

std::uint64_t GapStatistics::longer_than(double seconds) const {
  std::uint64_t count = 0;
  for (const auto& [number, bin] : bins_)
    if (bin.sum > seconds * 1.0625 * static_cast<double>(bin.count)) count += bin.count;
  return count;
}

GapStatistics::Timing GapStatistics::timing() const {
  Timing timing;
  double all = 0, sum = 0;
  for (const auto& [number, bin] : bins_) all += static_cast<double>(bin.count), sum += bin.sum;
  if (all == 0) return timing;
  const double pause = std::max(1.0, 10 * sum / all);
  double count = 0, seen = 0;
  for (const auto& [number, bin] : bins_) {
    if (bin.sum > pause * static_cast<double>(bin.count)) continue;
    count += static_cast<double>(bin.count);
    timing.length += bin.sum;
  }
  if (count == 0) {  // nothing but pauses
    count = all;
    timing.length = sum;
  }
  for (const auto& [number, bin] : bins_) {
    seen += static_cast<double>(bin.count);
    timing.median = bin.sum / static_cast<double>(bin.count);
    if (2 * seen > count) break;
  }
  const double mean = timing.length / count;
  if (mean > kBurst * timing.median && count >= 8) {
    double longer = 0, within = 0;  // gaps between bursts; sum of those within
    for (const auto& [number, bin] : bins_)
      if (bin.sum > mean * static_cast<double>(bin.count)) longer += static_cast<double>(bin.count);
      else within += bin.sum;
    timing.bursts = longer > 0 ? std::max(2.0, std::round((count + 1) / (longer + 1))) : count;
    timing.period = mean;  // else from the beginning of the first burst to that of the last
    if (longer > 0) timing.period = (timing.length - within / (longer + 1)) / ((count + 1) * longer / (longer + 1));
    return timing;
  }
  double periods = 0;
  for (const auto& [number, bin] : bins_) {
    const double gap = bin.sum / static_cast<double>(bin.count);
    if (gap <= pause || timing.length == sum) periods += std::round(gap / timing.median) * static_cast<double>(bin.count);
  }
  timing.period = periods > 0 ? timing.length / periods : mean;
  double squares = 0, near = 0;
  for (const auto& [number, bin] : bins_) {
    const double gap = bin.sum / static_cast<double>(bin.count);
    if (gap > 1.5 * timing.period) continue;
    near += static_cast<double>(bin.count);
    squares += (gap - timing.period) * (gap - timing.period) * static_cast<double>(bin.count);
  }
  if (near > 0) timing.spread = std::sqrt(squares / near);
  return timing;
}

std::uint32_t rate_of(const GapStatistics::Timing& timing) noexcept {
  if (!(timing.period > 0)) return TraceInfo().tick_rate;
  const double rate = std::clamp(1 / timing.period, 1.0, static_cast<double>(kMaxTickRate));
  // the first and the last time are off by a spread each; a burst's by its length; stamps may be cut to microseconds
  const double ends = 2 * std::max(timing.spread, 1e-6) + (timing.in_bursts() ? timing.bursts * timing.period : 0.0);
  const double uncertain = timing.length > 0 ? rate * std::min(ends / timing.length, 0.25) : 0;
  for (const double step : {1000.0, 500.0, 100.0, 50.0, 25.0, 20.0, 10.0, 5.0}) {
    const double whole = std::round(rate / step) * step;
    if (whole > 0 && std::abs(whole - rate) <= uncertain) return static_cast<std::uint32_t>(whole);
  }
  return static_cast<std::uint32_t>(std::llround(rate));
}

// ==== steps ====

void ClockSteps::add(std::uint64_t ordinal, std::uint32_t source, std::uint64_t log) {
  std::int64_t time = static_cast<std::int64_t>(log) + added();
  Last& last = last_[source];
  if (any_ && last.ordinal != 0 && time - std::max(high_, last.time) > kLeap) {
    steps_.push_back({ordinal, static_cast<std::uint64_t>(high_), added() - (time - high_)});
    time = high_;
  }
  const bool falls = any_ && last.ordinal != 0 && time < last.time - kStep;
  if (!any_ || time >= high_) {
    if (lagging_) disorder_ = std::max(disorder_, lag_);
    lagging_.reset();
    lag_ = 0;
    high_ = time;
    any_ = true;
  } else {
    if (!lagging_) lagging_ = Step{ordinal, static_cast<std::uint64_t>(high_), high_ - time + added()};
    if (!falls) lag_ = std::max(lag_, static_cast<std::uint64_t>(high_ - time));
  }
  last = {time, ordinal};
  if (!falls || !lagging_ || lagging_->added >= kFarthest) return;
  const Step step = *lagging_;
  const std::int64_t more = step.added - added();
  for (auto& [number, one] : last_)
    if (one.ordinal >= step.ordinal) {
      one.time += more;
      high_ = std::max(high_, one.time);
    }
  steps_.push_back(step);
  lagging_.reset();
  lag_ = 0;
}

void ClockSteps::end() {
  if (lagging_) disorder_ = std::max(disorder_, lag_);
}

std::int64_t ClockSteps::added_at(std::uint64_t ordinal) const noexcept {
  const auto after = std::upper_bound(steps_.begin(), steps_.end(), ordinal,
                                      [](std::uint64_t value, const Step& step) { return value < step.ordinal; });
  return after == steps_.begin() ? 0 : std::prev(after)->added;
}

// ==== clock ====

bool SourceFacts::stamps_are_usable() const noexcept {
  return stamps.count() > 1 && stampless == 0 && stamps.backward() == 0 && most_lag - least_lag <= kMostLagRange;
}

void RosClock::choose(const std::vector<SourceFacts>& facts, const std::vector<bool>& moving, RosStamps wanted) {
  uses_.assign(facts.size(), {});
  takes_stamps_ = wanted == RosStamps::header;
  for (std::size_t i = 0; i < facts.size() && wanted == RosStamps::automatic; ++i) {
    if (!moving[i] || facts[i].samples < 8 || !facts[i].stamps_are_usable()) continue;
    const auto log = facts[i].log.timing(), stamps = facts[i].stamps.timing();
    if (stamps.in_bursts() || !(stamps.period > 0)) continue;
    const bool agrees =
        std::abs(facts[i].log.length() - facts[i].stamps.length()) < 0.01 * facts[i].log.length() + log.bursts * log.period;
    const bool is_calmer = agrees && log.spread > 0.2 * log.period && stamps.spread < 0.5 * log.spread;
    takes_stamps_ = takes_stamps_ || log.in_bursts() || is_calmer;
  }
  std::int64_t least = 0, most = 0;
  for (std::size_t i = 0; i < facts.size(); ++i) {
    Use& use = uses_[i];
    const bool usable = wanted == RosStamps::header ? facts[i].stamps.count() > 0 : facts[i].stamps_are_usable();
    use.stamp = takes_stamps_ && usable && moving[i];
    if (use.stamp && std::abs(facts[i].least_lag) > kOtherClock) use.offset = facts[i].least_lag;
    if (use.stamp) {
      least = std::min(least, facts[i].least_lag - use.offset);
      most = std::max(most, std::min(facts[i].most_lag, facts[i].least_lag + kFar) - use.offset);
      continue;
    }
    const auto log = facts[i].log.timing();
    if (moving[i] && log.in_bursts()) {
      use.spread = static_cast<std::uint64_t>(std::llround(1e9 * log.period));
      use.far = std::llround(1e9 * (20 + 2 * log.bursts) * log.period) + kSecond / 10;
      most = std::max(most, static_cast<std::int64_t>(1e9 * 3 * log.bursts * log.period));
      least = std::min(least, -most);
    }
  }
  disorder_ = static_cast<std::uint64_t>(most - least);
}

GapStatistics::Timing RosClock::timing(std::uint32_t source, const std::vector<SourceFacts>& facts) const {
  return uses_[source].stamp ? facts[source].stamps.timing() : facts[source].log.timing();
}

std::optional<std::uint64_t> RosClock::time_of(const RosSample& sample, std::int64_t added) {
  Use& use = uses_[sample.source];
  const std::int64_t log = static_cast<std::int64_t>(sample.log) + added;
  std::int64_t time = log;
  if (use.stamp && sample.stamp != 0) {
    time = static_cast<std::int64_t>(sample.stamp) + use.offset;
    const bool goes_on =
        use.last != 0 && std::abs(time - static_cast<std::int64_t>(use.last)) < kFar;  // it is the log that is odd
    if (std::abs(time - log) > kFar && !goes_on) return std::nullopt;
    use.last = static_cast<std::uint64_t>(std::max<std::int64_t>(time, 0));
  }
  if (use.spread > 0) {
    const auto even = static_cast<std::int64_t>(use.last + use.spread);
    time = use.last != 0 && std::abs(even - log) < use.far ? even : log;
    use.last = static_cast<std::uint64_t>(time);
  }
  return time < 0 ? std::nullopt : std::optional(static_cast<std::uint64_t>(time));
}

}  // namespace tactus
