// SPDX-License-Identifier: Apache-2.0
/// Integer arithmetic with defined rounding, and the quaternion algebra built on it. spec/10-conventions.md sections 5 and 6.
/// Everything here gives the same bits on every platform; >> of a negative value shifts in ones (C++20).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>

namespace tactus {

using Vec3i = std::array<std::int32_t, 3>;
using Quat30 = std::array<std::int32_t, 4>;  ///< w, x, y, z; x 2^-30

inline constexpr std::int32_t kOne30 = 1 << 30;

/// Faster in a loop than a comparison, which calls memcmp.
constexpr bool is_zero(const Vec3i& v) noexcept { return (v[0] | v[1] | v[2]) == 0; }

/// round(v / 2^s), halves toward +infinity.   pre  0 <= s < 63, |v| < 2^62
constexpr std::int64_t round_shift(std::int64_t v, unsigned s) noexcept {
  return s == 0 ? v : (v + (std::int64_t{1} << (s - 1))) >> s;
}

/// floor((a + floor(b / 2)) / b): round to nearest, halves toward +infinity for even b.   pre  b > 0, |a| < 2^62
constexpr std::int64_t round_div(std::int64_t a, std::int64_t b) noexcept {
  const std::int64_t n = a + b / 2;
  const std::int64_t q = n / b;
  return q - (n % b < 0 ? 1 : 0);
}

constexpr std::int32_t saturate32(std::int64_t v) noexcept {
  return static_cast<std::int32_t>(
      std::clamp<std::int64_t>(v, std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()));
}

/// floor(sqrt(v)).   time about 20 ns.
constexpr std::uint32_t isqrt(std::uint64_t v) noexcept {
  if (v == 0) return 0;
  // Newton from above: the start is >= the root, the sequence falls until it reaches the floor. It lies on the tangent of the root at
  // 9/4 (by powers of 4): at most 9 % too high.
  const unsigned half = (static_cast<unsigned>(std::bit_width(v)) - 1) / 2;
  std::uint64_t x = ((v >> half) + (std::uint64_t{9} << half >> 2)) / 3 + 2;
  for (;;) {
    const std::uint64_t next = (x + v / x) >> 1;
    if (next >= x) return static_cast<std::uint32_t>(std::min<std::uint64_t>(x, 0xffffffffu));
    x = next;
  }
}

/// sin of an angle in units of 2^-32 turn, result x 2^-30. Error below 2.5 units.
constexpr std::int32_t sin30(std::uint32_t turn) noexcept {
  constexpr std::array<std::int64_t, 6> kC{1686629713, -693598663, 85569264,
                                           -5026852,   172032,     -3670};  // odd powers of a quarter turn
  const std::uint32_t quadrant = turn >> 30;
  std::int64_t t = turn & 0x3fffffffu;
  if (quadrant & 1) t = kOne30 - t;
  const std::int64_t s = round_shift(t * t, 30);
  std::int64_t sum = kC[5];
  for (int k = 4; k >= 0; --k) sum = kC[static_cast<std::size_t>(k)] + round_shift(sum * s, 30);
  const std::int64_t value = round_shift(sum * t, 30);
  return static_cast<std::int32_t>(quadrant & 2 ? -value : value);
}
constexpr std::int32_t cos30(std::uint32_t turn) noexcept { return sin30(turn + (1u << 30)); }

/// Smallest angle in [0, 2^30] (2^-32 turn) whose sine is at least s; s in [0, 2^30].   time about 50 ns up to 14 degrees, 0.3 us above.
constexpr std::uint32_t asin30(std::int32_t s) noexcept {
  if (s <= kOne30 / 4) {  // here sin30() nowhere falls: the series of the arc sine is off by a step or two
    constexpr std::int64_t kPerRadian = 683565276;                                                        // angles x 2^30
    constexpr std::array<std::int64_t, 6> kC{kOne30, 178956971, 80530637, 47934903, 32622364, 24021923};  // odd powers
    const std::int64_t square = round_shift(std::int64_t{s} * s, 30);
    std::int64_t sum = kC[5];
    for (std::size_t k = 5; k-- > 0;) sum = kC[k] + round_shift(sum * square, 30);
    auto angle = static_cast<std::uint32_t>(round_shift(round_shift(sum * s, 30) * kPerRadian, 30));
    while (angle > 0 && sin30(angle - 1) >= s) --angle;
    while (sin30(angle) < s) ++angle;
    return angle;
  }
  std::uint32_t low = 0, high = 1u << 30;
  while (low < high) {
    const std::uint32_t mid = low + (high - low) / 2;
    if (sin30(mid) >= s) high = mid;
    else low = mid + 1;
  }
  return low;
}

/// Hamilton product, each term exact, one rounding per component.   pre  |components| <= 2^30
constexpr Quat30 multiply(const Quat30& a, const Quat30& b) noexcept {
  const auto term = [](std::int32_t x, std::int32_t y) { return static_cast<std::int64_t>(x) * y; };
  const std::array<std::int64_t, 4> sum{term(a[0], b[0]) - term(a[1], b[1]) - term(a[2], b[2]) - term(a[3], b[3]),
                                        term(a[0], b[1]) + term(a[1], b[0]) + term(a[2], b[3]) - term(a[3], b[2]),
                                        term(a[0], b[2]) - term(a[1], b[3]) + term(a[2], b[0]) + term(a[3], b[1]),
                                        term(a[0], b[3]) + term(a[1], b[2]) - term(a[2], b[1]) + term(a[3], b[0])};
  Quat30 out{};
  for (std::size_t i = 0; i < 4; ++i) {
    out[i] = static_cast<std::int32_t>(std::clamp<std::int64_t>(round_shift(sum[i], 30), -kOne30, kOne30));
  }
  return out;
}

constexpr Quat30 conjugate(const Quat30& q) noexcept { return {q[0], -q[1], -q[2], -q[3]}; }

/// One Newton step of q / |q|: enough because every product of unit quaternions is off by a few units only.
constexpr Quat30 renormalise(const Quat30& q) noexcept {
  std::int64_t square = 0;
  for (const std::int32_t c : q) square += static_cast<std::int64_t>(c) * c;
  const std::int64_t factor = (3 * std::int64_t{kOne30} - round_shift(square, 30)) >> 1;
  Quat30 out{};
  for (std::size_t i = 0; i < 4; ++i) {
    out[i] = static_cast<std::int32_t>(std::clamp<std::int64_t>(round_shift(q[i] * factor, 30), -kOne30, kOne30));
  }
  return out;
}

/// The rotation by twice `half` (2^-32 turn) about `axis` (unit vector x 2^-30).
constexpr Quat30 axis_turn(const Vec3i& axis, std::uint32_t half) noexcept {
  const std::int64_t sine = sin30(half);
  return {cos30(half), static_cast<std::int32_t>(round_shift(axis[0] * sine, 30)),
          static_cast<std::int32_t>(round_shift(axis[1] * sine, 30)), static_cast<std::int32_t>(round_shift(axis[2] * sine, 30))};
}

}  // namespace tactus
