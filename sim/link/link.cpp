// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/elementary.h>
#include <tactus/sim/link/link.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include <tactus/base/rule.h>

namespace tactus::sim {
namespace {

constexpr Microseconds kHour = 3'600'000'000;
constexpr std::size_t kHeaders = 28;  // [bytes] of IPv4 and UDP

bool is_time(Microseconds t) noexcept { return t >= 0 && t <= kHour; }
bool is_fraction(double fraction) noexcept { return fraction >= 0 && fraction <= 1; }

/// One after the other, from 0 on.
bool are_in_order(const std::vector<DelayChange>& recorded) noexcept {
  if (recorded.empty()) return true;
  if (recorded.front().time != 0 || recorded.back().time <= 0) return false;
  for (std::size_t i = 0; i < recorded.size(); ++i)
    if (!is_time(recorded[i].delay) || (i > 0 && recorded[i].time <= recorded[i - 1].time)) return false;
  return true;
}

bool are_in_order(const std::vector<Outage>& outages) noexcept {
  Microseconds last = 0;
  for (const Outage& outage : outages) {
    if (outage.begin < last || outage.end <= outage.begin) return false;
    last = outage.end;
  }
  return true;
}

/// Fraction of good datagrams after which a burst begins: bursts of this mean length then make up `loss` of all.
double burst_begin(double loss, double burst) noexcept { return loss >= 1 ? 1 : loss / (burst * (1 - loss)); }

bool are_valid(const LinkOptions& o) noexcept {
  return is_time(o.delay) && is_time(o.jitter) && is_time(o.gamma_mean) && is_time(o.gamma_deviation) && is_time(o.gamma_piece) &&
         o.gamma_piece >= 1000 && (o.gamma_mean > 0 || o.gamma_deviation == 0) && is_time(o.held_back_by) &&
         is_fraction(o.loss) && is_fraction(o.duplicates) && is_fraction(o.held_back) && o.burst >= 1 && std::isfinite(o.burst) &&
         burst_begin(o.loss, o.burst) <= 1 && o.rate >= 0 && std::isfinite(o.rate) && are_in_order(o.recorded) &&
         are_in_order(o.outages);
}

/// Standard normal, by the polar method (Marsaglia and Bray 1964).
double normal(Random& random) noexcept {
  while (true) {
    const double u = random.uniform(-1, 1), v = random.uniform(-1, 1), s = u * u + v * v;
    if (s > 0 && s < 1) return u * std::sqrt(-2 * logarithm(s) / s);
  }
}

/// Gamma with this shape and scale 1 (Marsaglia and Tsang 2000).
double gamma(Random& random, double shape) noexcept {
  if (shape < 1) {
    const double fraction = power(random.uniform(0, 1), 1 / shape);
    return gamma(random, shape + 1) * fraction;
  }
  const double d = shape - 1.0 / 3, c = 1 / std::sqrt(9 * d);
  while (true) {
    const double x = normal(random), root = 1 + c * x;
    const double u = random.uniform(0, 1), v = root * root * root;
    if (v > 0 && logarithm(u) < 0.5 * x * x + d - d * v + d * logarithm(v)) return d * v;
  }
}

/// The heap's first is what arrives next.
constexpr auto kLater = [](const auto& a, const auto& b) { return a.due != b.due ? a.due > b.due : a.order > b.order; };

}  // namespace

Result<Link> Link::create(const LinkOptions& options) {
  if (!are_valid(options)) return fail(Errc::invalid_argument, "R-LNK-1");
  return Link(options);
}

Link::Link(const LinkOptions& options) : options_(options), loss_(0), jitter_(0), gamma_(0), duplicate_(0), held_(0) {
  Random seeds(options.seed);
  for (Random* stream : {&loss_, &jitter_, &gamma_, &duplicate_, &held_}) *stream = Random(seeds.next());
}

Result<void> Link::restart(const LinkOptions& options, Microseconds now) {
  TACTUS_TRY(Link next, create(options));
  next.heap_ = std::move(heap_);  // ordered as before
  for (InFlight& datagram : next.heap_) {
    datagram.due -= now;
    datagram.number = 0;
  }
  next.slots_ = std::move(slots_);
  next.free_slots_ = std::move(free_slots_);
  next.order_ = order_;
  *this = std::move(next);
  return {};
}

void Link::send(Microseconds now, std::span<const std::uint8_t> datagram) {
  ++counters_.sent;
  const bool is_lost = draw_loss();
  const double jitter = jitter_.uniform(0, 1), second_jitter = jitter_.uniform(0, 1);
  const bool is_doubled = duplicate_.uniform(0, 1) < options_.duplicates;
  const bool is_held = held_.uniform(0, 1) < options_.held_back;
  if (is_cut(now)) {
    ++counters_.cut;
    return;
  }
  if (is_lost) {
    ++counters_.lost;
    return;
  }
  const auto left = leave_queue(now, datagram.size());
  if (!left) {
    ++counters_.overflowed;
    return;
  }
  const Microseconds sure = *left + options_.delay + slow_delay(*left) + (is_held ? options_.held_back_by : 0);
  const auto span = static_cast<double>(options_.jitter);
  put(sure + std::llround(jitter * span), datagram);
  if (!is_doubled) return;
  ++counters_.duplicated;
  put(sure + std::llround(second_jitter * span), datagram);
}

std::optional<Link::Arrival> Link::poll(Microseconds now) noexcept {
  if (heap_.empty() || heap_.front().due > now) return std::nullopt;
  const InFlight first = heap_.front();
  std::pop_heap(heap_.begin(), heap_.end(), kLater);
  heap_.pop_back();
  free_slots_.push_back(first.slot);
  if (first.number > 0) ++counters_.arrived;
  if (first.number > 0 && first.number < newest_arrived_) ++counters_.reordered;
  newest_arrived_ = std::max(newest_arrived_, first.number);
  return Arrival{first.due, slots_[first.slot]};
}

std::optional<Microseconds> Link::next() const noexcept {
  if (heap_.empty()) return std::nullopt;
  return heap_.front().due;
}

bool Link::is_cut(Microseconds now) const noexcept {
  return std::ranges::any_of(options_.outages, [now](const Outage& o) { return o.begin <= now && now < o.end; });
}

/// A chain of two states: within a burst everything is lost, outside nothing (Gilbert 1960).
bool Link::draw_loss() noexcept {
  const double draw = loss_.uniform(0, 1);
  if (options_.burst <= 1 || options_.loss >= 1) return draw < options_.loss;
  const double enter = burst_begin(options_.loss, options_.burst), leave = 1 / options_.burst;
  in_burst_ = in_burst_ ? draw >= leave : draw < enter;
  return in_burst_;
}

std::optional<Microseconds> Link::leave_queue(Microseconds now, std::size_t size) noexcept {
  if (options_.rate <= 0) return now;
  const double per_byte = 8e6 / options_.rate;  // [us]
  const auto waiting = static_cast<double>(std::max<Microseconds>(0, free_at_ - now)) / per_byte;
  const auto bytes = static_cast<double>(size + kHeaders);
  if (waiting + bytes > static_cast<double>(options_.queue)) return std::nullopt;
  free_at_ = std::max(now, free_at_) + std::llround(std::ceil(bytes * per_byte));
  return free_at_;
}

/// What changes over time only: the recorded delay and that of the piece.
Microseconds Link::slow_delay(Microseconds now) noexcept {
  Microseconds delay = 0;
  if (const auto& recorded = options_.recorded; !recorded.empty()) {
    const Microseconds at = now % recorded.back().time;
    const auto after = std::ranges::upper_bound(recorded, at, {}, &DelayChange::time);
    delay = std::prev(after)->delay;
  }
  if (options_.gamma_mean == 0) return delay;
  for (const std::int64_t piece = now / options_.gamma_piece; piece_ < piece; ++piece_) {
    const auto mean = static_cast<double>(options_.gamma_mean), deviation = static_cast<double>(options_.gamma_deviation);
    const double shape = deviation > 0 ? mean * mean / (deviation * deviation) : 0;
    piece_delay_ = deviation > 0 ? std::llround(gamma(gamma_, shape) * mean / shape) : options_.gamma_mean;
  }
  return delay + piece_delay_;
}

void Link::put(Microseconds due, std::span<const std::uint8_t> datagram) {
  if (free_slots_.empty()) {
    slots_.emplace_back();
    free_slots_.reserve(slots_.capacity());  // so that poll() need not allocate
    free_slots_.push_back(static_cast<std::uint32_t>(slots_.size() - 1));
  }
  const std::uint32_t slot = free_slots_.back();
  slots_[slot].assign(datagram.begin(), datagram.end());
  free_slots_.pop_back();
  heap_.push_back({due, order_++, counters_.sent, slot});
  std::push_heap(heap_.begin(), heap_.end(), kLater);
}

}  // namespace tactus::sim
