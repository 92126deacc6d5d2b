// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/congestion.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace tactus {
namespace {

constexpr std::uint64_t kPeriod = 500'000;               // [us]
constexpr std::uint64_t kLongWait = 100'000;             // [us] of packets for their turn
constexpr std::uint32_t kLeastCalm = 1, kMostCalm = 64;  // periods

// Of the rate of a line.
constexpr std::uint64_t kLineEvery = 100'000;     // [us] from look to look
constexpr std::int32_t kShortest = 50'000;        // [us] of a measurement
constexpr std::int64_t kDrained = 10'000;         // [us] from look to look: the queue shrinks
constexpr int kProof = 2;                         // times that it was slowed down, without effect
constexpr std::uint64_t kLeastRate = 8'000;       // [bit/s]
constexpr std::uint64_t kFreeRate = 100'000'000;  // [bit/s] from which on there is no limit

// Of pieces of a declaration.
constexpr std::uint64_t kFirstGap = 500;  // [us]: 16 Mbit/s
constexpr std::uint64_t kFirstWindow = 16, kFewest = 4, kMostInFlight = 800;
constexpr std::uint64_t kMostMore = 16;       // 1/32 of the rate
constexpr std::int64_t kPieceQueue = 5'000;   // [us] on the line, at which fewer go
constexpr std::uint64_t kRecent = 1'000'000;  // [us]
constexpr std::int64_t kAckDelay = 10'000;    // [us] that an acknowledgement waits

}  // namespace

// ==== line pacer ====

std::uint64_t LinePacer::rate_gap() const noexcept {
  const auto measured = static_cast<std::uint64_t>(gaps_.value().value_or(16 * kFirstGap));
  return std::max(measured, 16 * least_gap_);
}

/// [us] of the queue that is too much; a piece takes its time on a slow line.
std::int64_t LinePacer::excess() const noexcept {
  return queue_ - kPieceQueue - variation_ / 2 - static_cast<std::int64_t>(rate_gap() / 16);
}

/// A queue goes in two round trips: one passes until its end is seen.
std::uint64_t LinePacer::gap() const noexcept {
  std::uint64_t gap = rate_gap();
  if (has_queue()) {
    const std::int64_t time = 2 * (least_ + kAckDelay);
    gap += gap * static_cast<std::uint64_t>(std::min(excess(), time / 4)) / static_cast<std::uint64_t>(time);
  } else if (gaps_.value()) {
    gap = gap * 32 / (32 + more_);
  }
  return std::max(gap / 16, least_gap_);
}

std::uint64_t LinePacer::window() const noexcept {
  if (is_blind_) return kFewest;
  if (!gaps_.value()) return kFirstWindow;
  return std::min(kFewest + static_cast<std::uint64_t>(least_ + kAckDelay) / gap(), kMostInFlight);
}

void LinePacer::sent(std::uint64_t number, std::uint64_t now) noexcept {
  if (first_number_ > 0) return;
  first_number_ = number;
  first_sent_ = static_cast<std::int64_t>(now);
}

void LinePacer::feedback(const Feedback& report, const RoundTrip& trip, std::uint64_t now) noexcept {
  if (first_number_ == 0 || report.number < first_number_) return;
  is_blind_ = false;
  recent_.add(report.arrived - report.sent, now);
  least_ = trip.least;
  variation_ = trip.variation;
  queue_ = *recent_.value() - least_;
  const Mark to{report.number, arrived_, report.sent, report.arrived};
  if (!mark_ && report.number > first_number_) begin(to, now);
  if (mark_) measure(to, now);
  else mark_ = to;
  if (has_queue()) more_ = 1;
  if (report.number < round_ends_) return;
  const bool is_first = std::exchange(round_ends_, report.newest_sent) == 0;
  if (!is_first && !has_queue()) more_ = std::min(2 * more_, kMostMore);
}

/// The acknowledgement has waited since the first arrived; unless they had come faster than they went: then it is the second.
void LinePacer::begin(const Mark& to, std::uint64_t now) noexcept {
  const std::int64_t first = static_cast<std::int64_t>(now) - kAckDelay;
  const bool is_second = 8 * (to.arrived - first) < 7 * (to.sent - first_sent_);
  mark_ = Mark{first_number_, 1, first_sent_, is_second ? first - kAckDelay : first};
}

/// A queue shows what the line carries; without one what is lost is lost by chance, if it is not much.
void LinePacer::measure(const Mark& to, std::uint64_t now) noexcept {
  const std::int64_t sending = to.sent - mark_->sent, arriving = to.arrived - mark_->arrived;
  const std::int64_t span = std::max({sending, arriving, std::int64_t{1}});
  const std::uint64_t numbers = to.number - mark_->number, came = to.count - mark_->count;
  if (gaps_.value() && span < kAckDelay + 4 * variation_) return;  // what varies would count for more than the line
  mark_ = to;
  const std::uint64_t counts = has_queue() ? came : std::min(numbers, came + came / 8);
  if (counts == 0) return;
  if (arriving > sending + sending / 4 + 2000) more_ = 1;
  if (has_queue() && arriving > sending + sending / 8 + 2 * variation_)
    gaps_ = WindowedMinimum(kRecent);  // this is what the line carries
  gaps_.add(static_cast<std::int64_t>(16 * static_cast<std::uint64_t>(span) / counts), now);
}

// ==== line rate ====

void LineRate::begin(std::uint64_t now) noexcept {
  *this = {};
  since_ = now;
}

void LineRate::sent(std::uint64_t number, std::uint64_t bytes, std::uint64_t now) noexcept {
  bytes_ += static_cast<std::uint32_t>(bytes);
  numbers_[number % kNumbers] = {static_cast<std::uint32_t>(now), bytes_, static_cast<std::uint32_t>(bytes)};
}

void LineRate::round_trip(const RoundTrip& trip, std::int64_t sample, std::uint64_t number, std::uint64_t now) noexcept {
  trip_ = trip;
  variation_.add(trip.variation, now);
  const Sent& sent = numbers_[number % kNumbers];
  const std::int64_t carried = -carried_.value().value_or(0);
  const std::int64_t own = carried == 0 ? 0 : std::int64_t{8'000'000} * sent.size / carried;
  recent_.add(std::max(trip.least, sample - own), now);
  newest_ = {sent.at + static_cast<std::uint32_t>(sample), sent.bytes, sent.size};
  has_news_ = true;
}

bool LineRate::is_jammed() const noexcept { return recent_.value() && queue() > 4 * limit(); }

/// What has arrived since the last measurement, and how long that took: the delay back counts as the same.
void LineRate::measure(std::uint64_t now) noexcept {
  const auto time = static_cast<std::int32_t>(newest_.at - mark_.at);
  if (time < kShortest) return;
  const std::uint64_t bits = 8 * std::uint64_t{newest_.bytes - mark_.bytes};
  if (mark_.bytes > 0) carried_.add(-static_cast<std::int64_t>(bits * 1'000'000 / static_cast<std::uint64_t>(time)), now);
  mark_ = newest_;
}

/// While there is a queue the line carries what it can.
void LineRate::slow_down(std::uint64_t now) noexcept {
  if (!carried_.value()) return;
  ceiling_ = static_cast<std::uint64_t>(-*carried_.value());
  const std::uint64_t less = ceiling_ * 3 / 4;
  rate_ = std::max(rate_ == 0 ? less : std::min(less, rate_ * 7 / 8), kLeastRate);
  since_ = now + static_cast<std::uint64_t>(*recent_.value());
  ++slowed_;
}

/// Slowly near the rate that was too much, and not while less is sent.
void LineRate::speed_up() noexcept {
  if (rate_ > kFreeRate) rate_ = 0;
  if (rate_ == 0 || !held_) return;
  const bool is_near = rate_ > ceiling_ - ceiling_ / 16 && rate_ < ceiling_ + ceiling_ / 8;
  rate_ += rate_ / (is_near ? 256 : 16);
}

/// What stays as it is while less and less is sent is no queue: the delay has become longer.
bool LineRate::is_longer(std::int64_t queue) noexcept {
  const bool is_same = queue > limit() && std::abs(queue - first_queue_) < kDrained;
  if (!is_same) first_queue_ = queue, slowed_ = 0;
  return slowed_ >= kProof;
}

void LineRate::tick(bool held, std::uint64_t now) noexcept {
  held_ = held_ || held;
  if (now < since_ + kLineEvery || !has_news_) return;
  since_ = now;
  measure(now);
  longer_ = std::min(longer_, *recent_.value());
  if (is_longer(queue())) longer_ = *recent_.value(), rate_ = 0;
  const std::int64_t queue = this->queue();
  const bool drains = queue + kDrained < queue_;
  if (queue > limit() && !drains) slow_down(now);
  else if (2 * queue < limit()) speed_up();
  queue_ = queue;
  held_ = has_news_ = false;
}

// ==== congestion ====

Congestion::Congestion(double most) noexcept
    : most_steps_(static_cast<unsigned>(std::floor(2 * std::log2(std::clamp(most, 1.0, 64.0)) + 1e-9))) {}

void Congestion::begin(std::uint64_t now) noexcept {
  steps_ = 0;
  since_ = looked_at_ = now;
  ticks_ = held_ = waits_begun_ = shapes_ = left_out_ = calm_ = 0;
  calm_needed_ = kLeastCalm;
  was_held_ = answered_ = waits_ = narrowed_ = false;
}

double Congestion::bound_scale() const noexcept { return std::exp2(0.5 * steps_); }

/// Of time, as ticks may be of any length.
Congestion::Period Congestion::judge() noexcept {
  const std::uint64_t wait = waits_begun_ == 0 ? 0 : kPeriod * held_ / ticks_ / waits_begun_;
  waits_ = 10 * held_ > ticks_;
  if (wait > kLongWait || 10 * left_out_ > shapes_) return Period::congested;
  if (!answered_) return Period::unknown;
  return 2 * wait > kLongWait || left_out_ > 0 ? Period::busy : Period::calm;
}

bool Congestion::step(Period period) noexcept {
  const unsigned before = steps_;
  if (period == Period::unknown) return false;
  calm_ = period == Period::calm ? calm_ + 1 : 0;
  if (period == Period::congested) {
    if (narrowed_) calm_needed_ = std::min(2 * calm_needed_, kMostCalm);
    narrowed_ = false;
    steps_ = std::min(steps_ + 1, most_steps_);
  } else if (calm_ >= calm_needed_) {
    if (narrowed_) calm_needed_ = kLeastCalm;  // the last one was not too early
    narrowed_ = steps_ > 0;
    steps_ -= steps_ > 0 ? 1 : 0;
    calm_ = 0;
  }
  return steps_ != before;
}

bool Congestion::tick(bool held, bool shapes, std::uint64_t now) noexcept {
  if (steps_ > 0) so_far_.time += now - looked_at_;
  looked_at_ = now;
  ++ticks_;
  held_ += held ? 1 : 0;
  waits_begun_ += held && (!was_held_ || held_ == 1) ? 1 : 0;
  shapes_ += shapes ? 1 : 0;
  left_out_ += shapes && held ? 1 : 0;
  was_held_ = held;
  if (now < since_ + kPeriod) return false;
  const bool changes = step(judge());
  so_far_.largest = std::max(so_far_.largest, bound_scale());
  since_ = now;
  ticks_ = held_ = waits_begun_ = shapes_ = left_out_ = 0;
  answered_ = false;
  return changes;
}

}  // namespace tactus
