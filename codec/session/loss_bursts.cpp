// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/loss_bursts.h>

#include <algorithm>

namespace tactus {
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

}  // namespace tactus
