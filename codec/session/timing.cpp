// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/timing.h>

#include <algorithm>

namespace tactus {

// ==== loss bursts ====

namespace {

constexpr std::uint64_t kShortest = 3;        // datagrams in a burst
constexpr std::uint64_t kStillMay = 100'000;  // [us]: what was overtaken by one that came so long ago comes no more

}  // namespace

void LossBursts::heard(std::uint64_t number, std::optional<std::int64_t> tick, std::uint64_t now) noexcept {
  if (number + kRemembered <= newest_) return;
  datagrams_[number % kRemembered] = {number, now, tick};
  newest_ = std::max(newest_, number);
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
constexpr std::int64_t kLongestBurst = 150'000;                // [us]
constexpr std::uint64_t kAdaptEvery = 100'000;                 // [us]
constexpr std::int64_t kShrink = 100;                          // [us] in this time: 1 ms per second
constexpr std::int64_t kLong = 150'000;                        // [us]: what is above goes sooner

constexpr std::int64_t floor_div(std::int64_t a, std::int64_t b) noexcept { return a / b - (a % b < 0 ? 1 : 0); }

}  // namespace

std::int64_t PlayoutClock::time_of(std::int64_t tick) const noexcept { return floor_div(tick * 1'000'000, tick_rate_); }

void PlayoutClock::heard(std::uint64_t number, std::optional<std::int64_t> tick, std::uint64_t now) noexcept {
  if (!options_.fixed) bursts_.heard(number, tick, now);
  if (!tick) return;
  const bool first = count_ == 0;
  add(static_cast<std::int64_t>(now) - time_of(*tick), now);
  if (first) shown_ = *tick;  // before it nothing is known
  if (first || now >= adapted_at_ + kAdaptEvery) adapt(now);
}

void PlayoutClock::late(std::int64_t tick, std::uint64_t now) noexcept {
  add(static_cast<std::int64_t>(now) - time_of(tick), now);
}

void PlayoutClock::add(std::int64_t lead, std::uint64_t now) noexcept {
  base_.add(lead, now);
  leads_[next_] = {lead, now};
  next_ = (next_ + 1) % kRemembered;
  count_ = std::min(count_ + 1, kRemembered);
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
  const auto end = sorted_.begin() + static_cast<std::ptrdiff_t>(count);
  const auto late_at = sorted_.begin() + static_cast<std::ptrdiff_t>((count * 999 + 999) / 1000 - 1);
  std::nth_element(sorted_.begin(), late_at, end);
  const std::int64_t base = *base_.value(), late = *late_at - base;
  std::int64_t early = 0;  // sum
  for (auto lead = sorted_.begin(); lead != end; ++lead) early += *late_at - *lead;
  const std::int64_t longest = kLongestBurst * tick_rate_ / 1'000'000;
  const std::int64_t slack = std::max(kSlack, time_of(bursts_.bridge(longest, now)));
  const std::int64_t wanted = late + std::max(kLeastSlack, slack - early / static_cast<std::int64_t>(count));
  delay_ = std::max(wanted, delay_ - std::max(kShrink, (delay_ - kLong) / 64));
}

std::int64_t PlayoutClock::shown(std::uint64_t now) noexcept {
  const auto base = base_.value();
  if (!base) return -1;
  const std::int64_t time = static_cast<std::int64_t>(now) - *base - delay_;
  shown_ = std::max(shown_, floor_div(time * tick_rate_, 1'000'000));
  return shown_;
}

std::optional<std::int64_t> PlayoutClock::behind(std::uint64_t now) const noexcept {
  const auto base = base_.value();
  if (!base || shown_ < 0) return std::nullopt;
  return static_cast<std::int64_t>(now) - *base - time_of(shown_);
}

}  // namespace tactus
