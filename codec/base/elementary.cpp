// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/elementary.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace tactus {
namespace {

// Constants in two or three parts, the first of which have zeros at their ends: products with small whole numbers are exact.
constexpr double kHalfPi1 = 0x1.921fb544p+0, kHalfPi2 = 0x1.0b4611a6p-34, kHalfPi3 = 0x1.3198a2e037073p-69;
constexpr double kLog2High = 0x1.62e42feep-1, kLog2Low = 0x1.a39ef35793c76p-33;

/// What each term of a series of factorials is divided by more than the one before.
template <std::size_t kTerms, int kFirst, int kStride>
constexpr std::array<double, kTerms> divisors() noexcept {
  std::array<double, kTerms> out{};
  int last = kFirst;
  for (double& divisor : out) {
    divisor = 1;
    for (int i = 0; i < kStride; ++i) divisor *= ++last;
  }
  return out;
}

/// sum of x^k / (first + stride k)! * first!, by Horner's rule.
template <std::size_t kTerms, int kFirst, int kStride>
double factorial_series(double x) noexcept {
  static constexpr auto kDivisors = divisors<kTerms, kFirst, kStride>();
  double out = 1;
  for (std::size_t k = kTerms; k-- > 0;) out = 1 + out * (x / kDivisors[k]);
  return out;
}

double sine_near(double r) noexcept { return r * factorial_series<9, 1, 2>(-r * r); }
double cosine_near(double r) noexcept { return factorial_series<9, 0, 2>(-r * r); }

struct Reduced {
  double rest;       // in [-pi/4, pi/4]
  unsigned quarter;  // modulo 4
};

Reduced reduce(double x) noexcept {
  const double n = std::floor(x * (2 / kPi) + 0.5);
  const double rest = ((x - n * kHalfPi1) - n * kHalfPi2) - n * kHalfPi3;
  return {rest, static_cast<unsigned>(static_cast<long long>(n) & 3)};
}

double sine_in(const Reduced& r) noexcept {
  const double size = r.quarter % 2 == 0 ? sine_near(r.rest) : cosine_near(r.rest);
  return r.quarter < 2 ? size : -size;
}

/// |x| <= 1: from the nearest of arc tangents that are known.
double arc_tangent(double x) noexcept {
  constexpr double kOf[] = {0, 0.24497866312686415417, 0.46364760900080611621, 0.64350110879328438680, kPi / 4};
  const double size = std::abs(x), nearest = std::floor(4 * size + 0.5), from = nearest / 4;
  const double t = (size - from) / (1 + size * from), t2 = t * t;
  double series = 0;
  for (int k = 10; k >= 1; --k) series = t2 * ((k % 2 == 0 ? 1.0 : -1.0) / (2 * k + 1) + series);
  const double out = kOf[static_cast<int>(nearest)] + (t + t * series);
  return x < 0 ? -out : out;
}

}  // namespace

double sine(double x) noexcept { return sine_in(reduce(x)); }

double cosine(double x) noexcept {
  Reduced r = reduce(x);
  r.quarter = (r.quarter + 1) % 4;
  return sine_in(r);
}

double angle_of(double y, double x) noexcept {
  if (x == 0 && y == 0) return 0;
  const double across = std::abs(y), along = std::abs(x);
  double out = across <= along ? arc_tangent(across / along) : kPi / 2 - arc_tangent(along / across);
  if (x < 0) out = kPi - out;
  return y < 0 ? -out : out;
}

double arc_sine(double x) noexcept { return angle_of(x, std::sqrt((1 - x) * (1 + x))); }
double arc_cosine(double x) noexcept { return angle_of(std::sqrt((1 - x) * (1 + x)), x); }

double exponential(double x) noexcept {
  if (!(x > -745.2)) return x < 0 ? 0 : x;
  if (x > 709.8) return std::numeric_limits<double>::infinity();
  const double n = std::floor(x * (1 / (kLog2High + kLog2Low)) + 0.5);
  const double r = (x - n * kLog2High) - n * kLog2Low;
  return std::ldexp(factorial_series<14, 0, 1>(r), static_cast<int>(n));
}

double exponential_less_one(double x) noexcept {
  return std::abs(x) < 0.5 ? x * factorial_series<15, 1, 1>(x) : exponential(x) - 1;
}

double logarithm(double x) noexcept {
  if (x == 0) return -std::numeric_limits<double>::infinity();
  int exponent = 0;
  double m = std::frexp(x, &exponent);  // [1/2, 1)
  if (m < 0.70710678118654752) m *= 2, --exponent;
  const double s = (m - 1) / (m + 1), s2 = s * s;
  double series = 0;
  for (int k = 11; k >= 1; --k) series = s2 * (1.0 / (2 * k + 1) + series);
  return exponent * kLog2High + (2 * (s + s * series) + exponent * kLog2Low);
}

double power(double x, double y) noexcept {
  if (y == 0) return 1;
  return x == 0 ? (y > 0 ? 0 : std::numeric_limits<double>::infinity()) : exponential(y * logarithm(x));
}

}  // namespace tactus
