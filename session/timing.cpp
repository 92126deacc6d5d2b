// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/timing.h>

#include <algorithm>
#include <cstdlib>

namespace tactus {

// ==== loss bursts ====

namespace {

constexpr std::uint64_t kShortest = 3;        // datagrams in a burst
constexpr std::uint64_t kStillMay = 100'000;  // [us]: what is reordered comes at most so long after a newer one

}  // namespace

void LossBursts::heard(std::uint64_t number, std::optional<std::int64_t> tick, std::uint64_t now) noexcept {
  if (number + kRemembered <= newest_) return;
  datagrams_[number % kRemembered] = {number, now, tick};
  newest_ = std::max(newest_, number);
  if (first_ == 0) first_ = number;
}

std::uint32_t LossBursts::loss(std::uint64_t now) const noexcept {
  constexpr std::uint64_t kLooked = 256, kLeast = 128;
  const std::uint64_t end = newest_old(now), begin = std::max(first_, end < kLooked ? 1 : end - kLooked + 1);
  std::uint64_t missing = 0;
  for (std::uint64_t number = begin; number <= end; ++number)
    missing += datagrams_[number % kRemembered].number != number ? 1u : 0u;
  return static_cast<std::uint32_t>((missing << 16) / std::max(kLeast, end + 1 - std::min(begin, end)));
}

/// Highest number up to which it is known what is lost.
std::uint64_t LossBursts::newest_old(std::uint64_t now) const noexcept {
  std::uint64_t out = 0;
  for (const Datagram& datagram : datagrams_)
    if (datagram.at + kStillMay <= now) out = std::max(out, datagram.number);
  return out;
}

std::int64_t LossBursts::bridge(std::int64_t longest, std::uint64_t now) noexcept {
  const std::uint64_t end = newest_old(now), begin = newest_ >= kRemembered ? newest_ - kRemembered + 1 : 1;
  std::optional<std::int64_t> before;                            // tick of the newest state
  std::uint64_t missing = 0, in_bursts = 0, row = 0, burst = 0;  // `burst` since `before`
  std::size_t count = 0;
  for (std::uint64_t number = begin; number <= end; ++number) {
    const Datagram& datagram = datagrams_[number % kRemembered];
    if (datagram.number != number) {
      ++row;
      continue;
    }
    missing += row;
    if (row >= kShortest) burst += row;
    row = 0;
    if (!datagram.tick) continue;
    in_bursts += burst;
    const std::int64_t span = before && burst > 0 ? *datagram.tick - *before : 0;
    if (span > 0 && span <= longest) spans_[count++] = span;
    before = std::max(before.value_or(*datagram.tick), *datagram.tick);
    burst = 0;
  }
  if (count == 0 || 2 * in_bursts <= missing) return 0;
  const auto longest_of_most = spans_.begin() + static_cast<std::ptrdiff_t>((2 * count + 2) / 3 - 1);
  std::nth_element(spans_.begin(), longest_of_most, spans_.begin() + static_cast<std::ptrdiff_t>(count));
  return *longest_of_most;
}

// ==== playout clock ====

namespace {

constexpr std::int64_t kSlack = 30'000, kLeastSlack = 10'000;  // [us]
constexpr std::int64_t kPromptSlack = 2'000;                   // [us] both where nothing is late and hardly anything lost
constexpr std::uint32_t kFewLost = 65536 / 100;                // fraction x 2^-16
constexpr std::int64_t kLongestBurst = 150'000;                // [us]
constexpr std::uint64_t kAdaptEvery = 100'000;                 // [us]
constexpr std::int64_t kShrink = 100;                          // [us] in this time: 1 ms per second
constexpr std::int64_t kLong = 150'000;                        // [us]: what is above goes sooner
constexpr std::uint64_t kUndecided = 1'000'000;  // [us] in which a change is found to be one of the link or of a clock
constexpr std::int64_t kAckDelay = 10'000, kMargin = 10'000,
                       kApart = 10'000;  // [us] of an acknowledgement; beyond; between copies
constexpr std::uint32_t kLossy = 65536 / 333, kLossier = 65536 / 20, kLossiest = 65536 * 3 / 20;  // fractions x 2^-16
constexpr std::int64_t kLeastJitter = 20'000;                                                     // [us]
constexpr std::int64_t kMostJitter = 50'000;  // [us] of round trips: what is above is a standstill or a queue
constexpr std::uint64_t kReordering = 5'000;  // [us] that a packet waits for one that is not lost but late
constexpr std::uint64_t kSettle = 20'000;     // [us] in which an end that woke up takes what has waited

constexpr std::int64_t floor_div(std::int64_t a, std::int64_t b) noexcept { return a / b - (a % b < 0 ? 1 : 0); }

}  // namespace

std::int64_t PlayoutClock::time_of(std::int64_t tick) const noexcept { return floor_div(tick * 1'000'000, tick_rate_); }

void PlayoutClock::heard(std::uint64_t number, std::optional<std::int64_t> tick, std::uint64_t now) noexcept {
  if (!options_.fixed) bursts_.heard(number, tick, now);
  const auto at = static_cast<std::int64_t>(now);
  const bool first = shown_ < 0 && tick;
  if (first) shown_ = *tick;  // before it nothing is known
  if (shown_ < 0) return;
  if (at - heard_at_ >= reach_) follows_ = false;
  heard_at_ = at;
  if (tick) observe(time_of(*tick), at - time_of(*tick)), learn(at - time_of(*tick), now);
  else if (follows_ && number > newest_ && !waits_) news_ = std::max(news_, at - lead_);  // as new as its delay lets it be
  newest_ = std::max(newest_, number);
  if (tick) add(at - time_of(*tick), now);
  if (first || (tick && now >= adapted_at_ + kAdaptEvery && is_settled(now))) adapt(now);
}

void PlayoutClock::clock_signalled(std::int64_t time, std::uint64_t now) noexcept {
  if (shown_ < 0) return;
  const std::int64_t lead = static_cast<std::int64_t>(now) - time;
  if (!waits_) observe(time, lead);
  if (time >= signalled_) lead_ = lead;  // also of a clock that stands
  signalled_ = std::max(signalled_, time);
  learn(lead, now);
  base_.add(lead, now);
  if (now >= adapted_at_ + kAdaptEvery && is_settled(now)) adapt(now);
}

/// Up to this time of the other end's ticks [us] something is known.
void PlayoutClock::observe(std::int64_t time, std::int64_t lead) noexcept {
  if (time > news_ || !follows_) lead_ = lead;
  news_ = std::max(news_, time);
  follows_ = true;
}

void PlayoutClock::repaired(std::int64_t tick) noexcept {
  if (shown_ >= 0) observe(time_of(tick), lead_);
}

void PlayoutClock::held(std::int64_t tick, std::uint64_t at, std::uint64_t now) noexcept {
  if (at < settled_at_) return;
  const bool first = shown_ < 0;
  const std::int64_t lead = static_cast<std::int64_t>(at) - time_of(tick);
  if (first) {
    shown_ = tick;
    heard_at_ = static_cast<std::int64_t>(now);
    observe(time_of(tick), lead);
  }
  learn(lead, now);
  add(lead, now);
  if (first || (now >= adapted_at_ + kAdaptEvery && is_settled(now))) adapt(now);
}

/// [us] from the sending of what is lost to the arrival of its copy, less the one-way delay.
std::int64_t PlayoutClock::repair_time() const noexcept {
  if (!repair_) return 0;
  const std::int64_t seen = 2 * (repair_->smoothed - repair_->least) + kLeastJitter;  // the variation begins far too high
  const std::int64_t trip = repair_->smoothed + std::min(4 * repair_->variation, seen);
  return std::min(trip, 2 * repair_->least + kMostJitter) + kAckDelay + kMargin;
}

void PlayoutClock::waits(std::optional<std::uint64_t> since, std::uint64_t now) noexcept {
  waits_ = since.has_value();
  if (!waits_ || options_.fixed) return;
  if (now > *since + std::max<std::uint64_t>(kReordering, static_cast<std::uint64_t>(late_ - least_)))
    delay_ = std::max(delay_, least_ + repair_time() + kApart);
}

/// How far behind to show, so that copies come in time: two or three rounds of them where copies get lost, too.
std::int64_t PlayoutClock::for_repair(std::uint64_t now) const noexcept {
  const std::uint32_t loss = bursts_.loss(now);
  if (loss > kLossiest) return 2 * repair_time() + 3 * kAckDelay;
  if (loss > kLossier) return repair_time() * 3 / 2 + kAckDelay;
  return loss > kLossy ? repair_time() + kApart : 0;
}

/// For whether a clock stood still.
void PlayoutClock::learn(std::int64_t lead, std::uint64_t now) noexcept {
  if (now < settled_at_) return;
  if (period_.leads == 0) {
    const std::int64_t base = base_.value().value_or(lead);
    const auto trip = trips_.value();
    period_ = {.since = now,
               .leads = 0,
               .least = lead,
               .most = lead,
               .trip = {},
               .base_before = base_then_.value_or(base),
               .trip_before = trip_then_ ? trip_then_ : trip};
    trip_then_ = trip;
    base_then_ = base;
  }
  period_.least = std::min(period_.least, lead);
  period_.most = std::max(period_.most, lead);
  ++period_.leads;
}

void PlayoutClock::late(std::int64_t tick, std::uint64_t now) noexcept {
  add(static_cast<std::int64_t>(now) - time_of(tick), now);
}

void PlayoutClock::measured(std::int64_t round_trip, std::uint64_t now) noexcept {
  const auto off = [this](std::int64_t trip) { return std::abs(trip - period_.trip_before.value_or(0)); };
  if (!period_.trip || off(round_trip) < off(*period_.trip)) period_.trip = round_trip;
  trips_.add(round_trip, now);
}

void PlayoutClock::wake(std::uint64_t now) noexcept {
  settled_at_ = now + kSettle;
  count_ = next_ = 0;
  period_ = {};
}

void PlayoutClock::add(std::int64_t lead, std::uint64_t now) noexcept {
  base_.add(lead, now);
  if (now < settled_at_) return;
  leads_[next_] = {lead, now};
  next_ = (next_ + 1) % kRemembered;
  count_ = std::min(count_ + 1, kRemembered);
}

/// A link whose delay changes has other round trips. If these are as before while every lead is later than any usual one, or
/// one far earlier, a clock or the other end's ticks stood still: these leads are the first of a new time.
/// out  false: there is a change, and not known yet of what
bool PlayoutClock::is_settled(std::uint64_t now) noexcept {
  const std::int64_t change = period_.least - period_.base_before;
  const bool changed = period_.leads > 0 && (change > kClockStep - spread_.value().value_or(0) || change < -kClockStep);
  const bool known = period_.leads >= 2 && period_.trip && now >= period_.since + kAdaptEvery;
  if (changed && period_.trip_before && !known && now < period_.since + kUndecided) return false;
  const bool anew =
      changed && known && period_.trip_before && 2 * std::abs(*period_.trip - *period_.trip_before) < std::abs(change);
  if (anew) begin_anew(now);
  if (period_.leads > 0) {
    const bool had_both = anew && change + last_spread_ <= kClockStep;
    if (!had_both) spread_.add(last_spread_, now);
    last_spread_ = period_.least - period_.most;
  }
  period_ = {};
  return true;
}

void PlayoutClock::begin_anew(std::uint64_t now) noexcept {
  base_ = WindowedMinimum(kDelayWindow);
  base_.add(period_.least, now);
  base_then_.reset();
  count_ = next_ = 0;
  news_ = static_cast<std::int64_t>(now) - lead_;
  signalled_ = 0;
  shown_ = std::min(shown_, floor_div((news_ + reach_) * tick_rate_, 1'000'000));
}

void PlayoutClock::adapt(std::uint64_t now) noexcept {
  adapted_at_ = now;
  if (options_.fixed) {
    delay_ = *options_.fixed;
    return;
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < count_; ++i)
    if (leads_[i].at + kRecent >= now) sorted_[count++] = leads_[i].lead;
  if (count == 0) return;  // just awake
  const auto end = sorted_.begin() + static_cast<std::ptrdiff_t>(count);
  const auto late_at = sorted_.begin() + static_cast<std::ptrdiff_t>((count * 999 + 999) / 1000 - 1);
  std::nth_element(sorted_.begin(), late_at, end);
  const std::int64_t base = *base_.value();
  late_ = *late_at - base;
  std::int64_t early = 0;  // sum
  for (auto lead = sorted_.begin(); lead != end; ++lead) early += *late_at - *lead;
  least_ = *std::min_element(sorted_.begin(), late_at + 1) - base;
  const std::int64_t longest = kLongestBurst * tick_rate_ / 1'000'000;
  const bool is_prompt = !repair_ && bursts_.loss(now) <= kFewLost;
  const std::int64_t single = is_prompt ? std::clamp(late_, kPromptSlack, kSlack) : kSlack;
  const std::int64_t slack = std::max(single, time_of(bursts_.bridge(longest, now)));
  const std::int64_t least = is_prompt ? std::clamp(late_ / 3, kPromptSlack, kLeastSlack) : kLeastSlack;
  const std::int64_t usual = late_ + std::max(least, slack - early / static_cast<std::int64_t>(count));
  const std::int64_t wanted = repair_ ? std::max(usual, least_ + for_repair(now)) : usual;
  delay_ = std::max(wanted, delay_ - std::max(kShrink, (delay_ - kLong) / 64));
}

std::int64_t PlayoutClock::shown(std::uint64_t now) noexcept {
  const auto base = base_.value();
  if (!base) return -1;
  const std::int64_t time = static_cast<std::int64_t>(now) - *base - delay_;
  shown_ = std::max(shown_, floor_div(std::min(time, news_ + reach_) * tick_rate_, 1'000'000));
  return shown_;
}

std::int64_t PlayoutClock::ahead() const noexcept { return shown_ < 0 ? 0 : std::max<std::int64_t>(0, time_of(shown_) - news_); }

std::optional<std::int64_t> PlayoutClock::behind(std::uint64_t now) const noexcept {
  const auto base = base_.value();
  if (!base || shown_ < 0) return std::nullopt;
  return static_cast<std::int64_t>(now) - *base - time_of(shown_);
}

}  // namespace tactus
