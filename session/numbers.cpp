// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/numbers.h>

#include <algorithm>
#include <cstdlib>

#include <tactus/base/rule.h>

namespace tactus {

// ==== sent numbers ====

std::optional<std::uint64_t> SentNumbers::next() const noexcept {
  if (next_ > highest_ + kMostAhead) return std::nullopt;
  return next_;
}

void SentNumbers::send(std::uint64_t now) noexcept {
  slots_[next_ % kRemembered] = {next_, now, Fate::open};
  ++next_;
}

SentNumbers::Slot* SentNumbers::find(std::uint64_t number) noexcept {
  Slot& slot = slots_[number % kRemembered];
  return slot.number == number ? &slot : nullptr;
}

bool SentNumbers::is_open(std::uint64_t number) const noexcept {
  const Slot& slot = slots_[number % kRemembered];
  return slot.number == number && slot.fate == Fate::open;
}

std::optional<std::uint64_t> SentNumbers::oldest() const noexcept {
  for (std::uint64_t number = first_open_; number < next_; ++number)
    if (is_open(number)) return slots_[number % kRemembered].time;
  return std::nullopt;
}

Result<std::uint64_t> SentNumbers::extend(const Acknowledgement& ack) const noexcept {
  const auto behind = static_cast<std::uint16_t>(next_ - 1 - ack.newest);
  if (behind >= kMostAhead || behind + std::uint64_t{1} >= next_) return fail(Errc::invalid, "R-SES-6");
  return next_ - 1 - behind;
}

/// RFC 9002 section 5.3, with the time that the other end held the datagram taken off.
void SentNumbers::measure(std::uint64_t newest, std::uint16_t held, std::uint64_t now) noexcept {
  const Slot* slot = find(newest);
  sample_.reset();
  if (slot == nullptr || slot->fate == Fate::arrived || held == Acknowledgement::kNoTiming) return;
  const auto sample = std::max<std::int64_t>(0, static_cast<std::int64_t>(now - slot->time) - std::int64_t{16} * held);
  sample_ = sample;
  least_.add(sample, now);
  if (!round_trip_) {
    round_trip_ = RoundTrip{sample, sample / 2, sample};
    return;
  }
  RoundTrip& trip = *round_trip_;
  trip.variation += (std::abs(trip.smoothed - sample) - trip.variation) / 4;
  trip.smoothed += (sample - trip.smoothed) / 8;
  trip.least = *least_.value();
}

bool SentNumbers::mark(std::uint64_t number) noexcept {
  highest_ = std::max(highest_, number);
  Slot* slot = find(number);
  if (slot == nullptr || slot->fate == Fate::arrived) return false;
  if (slot->fate == Fate::open) count(false);
  slot->fate = Fate::arrived;
  return true;
}

bool SentNumbers::is_lost(std::uint64_t number, std::uint64_t newest, std::uint64_t now) noexcept {
  Slot* slot = find(number);
  if (slot == nullptr || slot->fate != Fate::open || !round_trip_) return false;
  const std::int64_t waited = static_cast<std::int64_t>(now - slot->time);
  const std::int64_t timeout = round_trip_->smoothed + std::max<std::int64_t>(4 * round_trip_->variation, 1000);
  if (waited <= timeout && newest - number <= 64) return false;
  slot->fate = Fate::lost;
  count(true);
  return true;
}

void SentNumbers::count(bool lost) noexcept {
  const std::uint64_t bit = std::uint64_t{1} << (fate_next_ % 64);
  std::uint64_t& word = fates_[fate_next_ / 64];
  word = lost ? word | bit : word & ~bit;
  fate_next_ = (fate_next_ + 1) % 256;
  fate_count_ = std::min<std::size_t>(fate_count_ + 1, 256);
}

std::uint32_t SentNumbers::loss() const noexcept {
  std::uint32_t lost = 0;
  for (const std::uint64_t word : fates_) lost += static_cast<std::uint32_t>(std::popcount(word));
  constexpr std::size_t kLeast = 128;  // one of a few that is lost says little
  return (lost << 16) / static_cast<std::uint32_t>(std::max(fate_count_, kLeast));
}

// ==== received numbers ====

namespace {

constexpr std::uint64_t kAhead = 4096;  // SentNumbers::kMostAhead
constexpr std::uint64_t kBehind = kNumbers - 1 - kAhead;

std::size_t word(std::uint64_t number) noexcept { return static_cast<std::size_t>(number / 64 % (NumberWindow::kReach / 64)); }
std::uint64_t bit(std::uint64_t number) noexcept { return std::uint64_t{1} << (number % 64); }

}  // namespace

bool NumberWindow::has(std::uint64_t number) const noexcept {
  return number <= newest_ && !is_too_old(number) && (bits_[word(number)] & bit(number)) != 0;
}

void NumberWindow::add(std::uint64_t number) noexcept {
  if (number > newest_ + kReach) {
    bits_ = {};
    newest_ = number;
  }
  for (; newest_ < number; bits_[word(newest_)] &= ~bit(newest_)) ++newest_;
  bits_[word(number)] |= bit(number);
}

Result<std::uint64_t> ReceivedNumbers::extend(std::uint16_t wire) const noexcept {
  const std::uint64_t newest = received_.newest();
  const std::uint64_t ahead = (wire + kBehind - newest) % kNumbers;
  if (newest + ahead < kBehind + 1) return fail(Errc::state, "R-SES-4");  // numbers count from 1
  const std::uint64_t number = newest + ahead - kBehind;
  if (received_.is_too_old(number) || received_.has(number)) return fail(Errc::state, "R-SES-4");
  return number;
}

void ReceivedNumbers::accept(std::uint64_t number, std::uint64_t now, AckTiming timing, const AckDelay& delay) noexcept {
  if (accepted_.is_too_old(number)) return;
  if (number > accepted_.newest()) newest_at_ = now;
  accepted_.add(number);
  if (number > reported_) ++above_reported_;
  else changes_reported_ = true;
  const bool full = ++unreported_ >= kUnreported;
  if (timing == AckTiming::never && !full) return;
  const std::uint64_t usual = timing == AckTiming::now || full ? now : now + delay.usual;
  if (!eliciting_at_) eliciting_at_ = now;
  const bool is_well = usual > now && !changes_reported_ && above_reported_ == accepted_.newest() - reported_;
  due_ = is_well ? *eliciting_at_ + delay.all_is_well : std::min(due_.value_or(usual), usual);
}

Acknowledgement ReceivedNumbers::acknowledge(std::uint64_t now) noexcept {
  due_.reset();
  eliciting_at_.reset();
  reported_ = accepted_.newest();
  above_reported_ = 0;
  changes_reported_ = false;
  unreported_ = 0;
  Acknowledgement out;
  const std::uint64_t newest = accepted_.newest();
  out.newest = static_cast<std::uint16_t>(newest);
  out.held = static_cast<std::uint16_t>(std::min<std::uint64_t>((now - newest_at_) / 16, Acknowledgement::kNoTiming));
  for (std::uint64_t i = 0; i < 64; ++i)
    if (newest > 1 + i && !accepted_.has(newest - 1 - i)) out.missing |= std::uint64_t{1} << i;
  return out;
}

}  // namespace tactus
