// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/motion.h>

#include <algorithm>
#include <bit>
#include <cstdlib>

#include <tactus/base/fixed.h>

namespace tactus {
namespace {

constexpr std::int64_t kLimit = 1 << 27;         // of a predicted increment
constexpr std::int64_t kProductLimit = 1 << 24;  // increments enter the correlations no larger than this
constexpr unsigned kFading = 5;                  // the correlations forget by 2^-5 per packet
constexpr unsigned kCoefficientBits = 12;

struct Coefficients {
  std::int64_t first = 0, second = 0;  // x 2^-12
};

/// Solve [11 12; 12 22] coefficients = [01; 02], slightly damped.
Coefficients coefficients_of(const std::array<std::int64_t, 5>& correlations) noexcept {
  std::uint64_t largest = 0;
  for (const std::int64_t s : correlations) largest = std::max(largest, static_cast<std::uint64_t>(std::abs(s)));
  const auto width = static_cast<unsigned>(std::bit_width(largest));
  const unsigned shift = width > 24 ? width - 24 : 0;
  std::array<std::int64_t, 5> s{};
  for (std::size_t i = 0; i < 5; ++i) s[i] = correlations[i] >> shift;
  s[0] += (s[0] >> 6) + 1;
  s[2] += (s[2] >> 6) + 1;
  const std::int64_t det = s[0] * s[2] - s[1] * s[1];
  if (det <= 0) return {};
  const auto tap = [det](std::int64_t numerator) {
    constexpr std::int64_t kTwo = 2 << kCoefficientBits;
    return std::clamp(round_div(numerator << kCoefficientBits, det), -kTwo, kTwo);
  };
  return {tap(s[3] * s[2] - s[4] * s[1]), tap(s[4] * s[0] - s[3] * s[1])};
}

}  // namespace

void ModeMotion::predict(std::uint32_t steps, std::span<std::int32_t> out) const noexcept {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const Channel& c = channels_[i];
    out[i] = 0;
    if (c.last == 0 && c.before == 0) continue;
    const Coefficients coefficients = coefficients_of(c.correlations);
    std::int64_t last = c.last, before = c.before, sum = 0;
    const std::int64_t bound = std::min(kLimit, 2 * std::max(std::abs(last), std::abs(before)));
    for (std::uint32_t n = 0; n < std::min(steps, kMaxSteps); ++n) {
      const std::int64_t next =
          std::clamp(round_shift(coefficients.first * last + coefficients.second * before, kCoefficientBits), -bound, bound);
      before = last;
      last = next;
      sum += next;
    }
    out[i] = static_cast<std::int32_t>(std::clamp(sum, -kLimit, kLimit));
  }
}

void ModeMotion::update(std::uint32_t steps, std::span<const std::int32_t> increments) noexcept {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    Channel& c = channels_[i];
    if (steps == 0) {
      c.last = saturate32(std::int64_t{c.last} + increments[i]);
      continue;
    }
    const auto now = static_cast<std::int32_t>(round_div(increments[i], steps));
    if (steps == 1) {
      const auto product = [](std::int64_t a, std::int64_t b) {
        return std::clamp(a, -kProductLimit, kProductLimit) * std::clamp(b, -kProductLimit, kProductLimit);
      };
      const std::array<std::int64_t, 5> products{product(c.last, c.last), product(c.last, c.before), product(c.before, c.before),
                                                 product(now, c.last), product(now, c.before)};
      for (std::size_t k = 0; k < 5; ++k) c.correlations[k] += products[k] - (c.correlations[k] >> kFading);
    }
    c.before = steps == 1 ? c.last : now;
    c.last = now;
  }
}

}  // namespace tactus
