// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/congestion.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tactus {
namespace {

constexpr std::uint64_t kPeriod = 500'000;                     // [us]
constexpr std::int64_t kQueue = 80'000;                        // [us] that the fastest datagram of a period may wait
constexpr std::int64_t kShorter = 20'000;                      // [us] in a period: the queue shrinks
constexpr std::uint32_t kPatience = 4, kLongestPatience = 64;  // periods

}  // namespace

Congestion::Congestion(double most) noexcept
    : most_steps_(static_cast<unsigned>(std::floor(2 * std::log2(std::clamp(most, 1.0, 64.0)) + 1e-9))) {}

void Congestion::begin(std::uint64_t now) noexcept {
  steps_ = 0;
  since_ = looked_at_ = now;
  ticks_ = held_ = calm_ = 0;
  least_ = std::numeric_limits<std::int64_t>::max();
  queue_ = 0;
  recent_ = WindowedMinimum(100'000);
  patience_ = kPatience;
  narrowed_ = false;
}

double Congestion::widening() const noexcept { return std::exp2(0.5 * steps_); }

void Congestion::round_trip(const RoundTrip& trip, std::int64_t sample, std::uint64_t now) noexcept {
  trip_ = trip;
  recent_.add(sample, now);
  least_ = std::min(least_, sample);
}

bool Congestion::is_jammed() const noexcept {
  return recent_.value() && *recent_.value() - trip_.least > 2 * std::max(kQueue, 2 * trip_.variation);
}

Congestion::Period Congestion::judge() noexcept {
  if (10 * held_ > ticks_) return Period::congested;
  if (least_ == std::numeric_limits<std::int64_t>::max()) return Period::unknown;
  const std::int64_t queue = least_ - trip_.least;
  const std::int64_t jitter = std::max(kQueue, 2 * trip_.variation);
  const bool shrinks = queue + kShorter <= std::exchange(queue_, queue);
  if (queue > jitter && !shrinks) return Period::congested;
  return held_ > 0 || 2 * queue > jitter ? Period::busy : Period::calm;
}

bool Congestion::step(Period period) noexcept {
  const unsigned before = steps_;
  if (period == Period::unknown) return false;
  calm_ = period == Period::calm ? calm_ + 1 : 0;
  if (period == Period::congested) {
    if (narrowed_) patience_ = std::min(2 * patience_, kLongestPatience);
    narrowed_ = false;
    steps_ = std::min(steps_ + 1, most_steps_);
  } else if (calm_ >= patience_) {
    if (narrowed_) patience_ = kPatience;  // the last one was not too early
    narrowed_ = steps_ > 0;
    steps_ -= steps_ > 0 ? 1 : 0;
    calm_ = 0;
  }
  return steps_ != before;
}

bool Congestion::tick(bool held, std::uint64_t now) noexcept {
  if (steps_ > 0) so_far_.time += now - looked_at_;
  looked_at_ = now;
  ++ticks_;
  held_ += held ? 1 : 0;
  if (now < since_ + kPeriod) return false;
  const bool changes = step(judge());
  so_far_.widest = std::max(so_far_.widest, widening());
  since_ = now;
  ticks_ = held_ = 0;
  least_ = std::numeric_limits<std::int64_t>::max();
  return changes;
}

}  // namespace tactus
