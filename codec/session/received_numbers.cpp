// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/received_numbers.h>

#include <algorithm>

#include <tactus/base/rule.h>

namespace tactus {
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

void ReceivedNumbers::accept(std::uint64_t number, std::uint64_t now, Asks asks, const Patience& patience) noexcept {
  if (accepted_.is_too_old(number)) return;
  if (number > accepted_.newest()) newest_at_ = now;
  accepted_.add(number);
  if (number > told_) ++above_told_;
  else changes_told_ = true;
  const bool full = ++untold_ >= kUntold;
  if (asks == Asks::never && !full) return;
  const std::uint64_t usual = asks == Asks::now || full ? now : now + patience.usual;
  if (!asked_at_) asked_at_ = now;
  const bool is_well = usual > now && !changes_told_ && above_told_ == accepted_.newest() - told_;
  due_ = is_well ? *asked_at_ + patience.all_is_well : std::min(due_.value_or(usual), usual);
}

Acknowledgement ReceivedNumbers::acknowledge(std::uint64_t now) noexcept {
  due_.reset();
  asked_at_.reset();
  told_ = accepted_.newest();
  above_told_ = 0;
  changes_told_ = false;
  untold_ = 0;
  Acknowledgement out;
  const std::uint64_t newest = accepted_.newest();
  out.newest = static_cast<std::uint16_t>(newest);
  out.held = static_cast<std::uint16_t>(std::min<std::uint64_t>((now - newest_at_) / 16, Acknowledgement::kNoTiming));
  for (std::uint64_t i = 0; i < 64; ++i)
    if (newest > 1 + i && !accepted_.has(newest - 1 - i)) out.missing |= std::uint64_t{1} << i;
  return out;
}

}  // namespace tactus
