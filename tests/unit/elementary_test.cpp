// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include <tactus/base/elementary.h>

namespace tactus {
namespace {

/// Distance in units in the last place of b.
double units(double a, double b) {
  if (a == b) return 0;
  return std::abs(a - b) / (std::nextafter(std::abs(b), std::numeric_limits<double>::infinity()) - std::abs(b));
}

class Drawn {
 public:
  double operator()(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 bits_{5};
};

TEST(Elementary, IsAsExactAsItSays) {
  Drawn drawn;
  for (int i = 0; i < 200'000; ++i) {
    const double turn = drawn(-100, 100), x = drawn(-2, 2), y = drawn(-2, 2), small = drawn(-1, 1), e = drawn(-700, 700);
    ASSERT_NEAR(sine(turn), std::sin(turn), 3e-16) << turn;
    ASSERT_NEAR(cosine(turn), std::cos(turn), 3e-16) << turn;
    ASSERT_NEAR(sine(1e4 * turn), std::sin(1e4 * turn), 1e-15) << 1e4 * turn;
    ASSERT_LE(units(angle_of(y, x), std::atan2(y, x)), 3) << y << ' ' << x;
    ASSERT_LE(units(arc_sine(small), std::asin(small)), 3) << small;
    ASSERT_LE(units(arc_cosine(small), std::acos(small)), 3) << small;
    ASSERT_LE(units(exponential(e), std::exp(e)), 3) << e;
    ASSERT_LE(units(exponential_less_one(small), std::expm1(small)), 3) << small;
    const double positive = std::exp(e);
    ASSERT_LE(units(logarithm(positive), std::log(positive)), 3) << positive;
    ASSERT_LE(units(power(std::abs(x), y), std::pow(std::abs(x), y)), 3 + 2 * std::abs(y * std::log(std::abs(x))))
        << x << ' ' << y;
  }
}

TEST(Elementary, Ends) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(sine(0.0), 0);
  EXPECT_EQ(cosine(0.0), 1);
  EXPECT_EQ(angle_of(0, 0), 0);
  EXPECT_EQ(angle_of(1, 0), kPi / 2);
  EXPECT_EQ(angle_of(-1, 0), -kPi / 2);
  EXPECT_EQ(angle_of(0, -1), kPi);
  EXPECT_EQ(arc_sine(1), kPi / 2);
  EXPECT_EQ(arc_cosine(-1), kPi);
  EXPECT_EQ(exponential(0), 1);
  EXPECT_EQ(exponential(-1000), 0);
  EXPECT_EQ(exponential(1000), kInfinity);
  EXPECT_TRUE(std::isnan(exponential(std::numeric_limits<double>::quiet_NaN())));
  EXPECT_EQ(exponential_less_one(0), 0);
  EXPECT_EQ(logarithm(1), 0);
  EXPECT_EQ(logarithm(0), -kInfinity);
  EXPECT_EQ(power(0, 2), 0);
  EXPECT_EQ(power(3, 0), 1);
  EXPECT_EQ(logarithm(std::numeric_limits<double>::denorm_min()), std::log(std::numeric_limits<double>::denorm_min()));
}

/// The same bits with every compiler, optimisation and processor: the hash is of this table.
TEST(Elementary, GivesTheSameBitsEverywhere) {
  Drawn drawn;
  std::uint64_t hash = 0xcbf29ce484222325;
  for (int i = 0; i < 10'000; ++i) {
    const double a = drawn(-30, 30), b = drawn(-30, 30), small = drawn(-1, 1), positive = drawn(0, 100);
    for (const double value : std::array{sine(a), cosine(a), angle_of(a, b), arc_sine(small), arc_cosine(small), exponential(a),
                                         exponential_less_one(small), logarithm(positive), power(positive, small)}) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3;
    }
  }
  EXPECT_EQ(hash, 2231473193115029148u);
}

}  // namespace
}  // namespace tactus
