// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/fixed.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace tactus {
namespace {

double turns(std::uint32_t t) { return t / 4294967296.0 * 2 * std::numbers::pi; }

TEST(Fixed, RoundingGoesHalfUpForBothSigns) {
  EXPECT_EQ(round_shift(5, 1), 3);
  EXPECT_EQ(round_shift(-5, 1), -2);
  EXPECT_EQ(round_shift(-6, 2), -1);
  EXPECT_EQ(round_shift(7, 0), 7);
  EXPECT_EQ(round_div(7, 2), 4);
  EXPECT_EQ(round_div(-7, 2), -3);
  EXPECT_EQ(round_div(-8, 3), -3);
  for (std::int64_t a = -50; a <= 50; ++a) {
    for (std::int64_t b = 1; b <= 9; ++b) {
      EXPECT_EQ(round_div(a, b), static_cast<std::int64_t>(
                                     std::floor((static_cast<double>(a) + static_cast<double>(b / 2)) / static_cast<double>(b))));
    }
  }
}

TEST(Fixed, SaturatesAtBothEnds) {
  EXPECT_EQ(saturate32(std::int64_t{1} << 40), 2147483647);
  EXPECT_EQ(saturate32(-(std::int64_t{1} << 40)), -2147483648LL);
  EXPECT_EQ(saturate32(-5), -5);
}

TEST(Fixed, SquareRootIsTheFloor) {
  std::mt19937_64 random(1);
  const auto check = [](std::uint64_t v) {
    const std::uint64_t r = isqrt(v);
    EXPECT_LE(r * r, v);
    if (r < 0xffffffffu) {
      EXPECT_GT((r + 1) * (r + 1), v);
    }
  };
  for (std::uint64_t v = 0; v < 1000; ++v) check(v);
  for (int i = 0; i < 20000; ++i) check(random() >> (random() % 64));
  for (std::uint64_t r : {65535ull, 65536ull, 0xfffffffeull, 0xffffffffull}) {
    check(r * r);
    check(r * r - 1);
  }
  check(~std::uint64_t{0});
}

TEST(Fixed, SineIsWithinItsStatedError) {
  EXPECT_EQ(sin30(0), 0);
  EXPECT_EQ(sin30(1u << 30), kOne30);
  EXPECT_EQ(sin30(3u << 30), -kOne30);
  EXPECT_EQ(cos30(0), kOne30);
  double worst = 0;
  std::mt19937 random(2);
  for (int i = 0; i < 200000; ++i) {
    const auto t = static_cast<std::uint32_t>(random());
    worst = std::max(worst, std::abs(sin30(t) - std::sin(turns(t)) * kOne30));
  }
  EXPECT_LT(worst, 2.5);
}

TEST(Fixed, ArcSineInvertsTheSine) {
  EXPECT_EQ(asin30(0), 0u);
  std::vector<std::int32_t> sines{759250125, kOne30 - 1, kOne30};
  for (std::int32_t s = 1; s < kOne30 / 2; s += 1 + s / 1000) sines.push_back(s);
  for (std::int32_t s = kOne30 / 4 - 1000; s < kOne30 / 4 + 1000; ++s) sines.push_back(s);  // below, it is found by a series
  for (const std::int32_t s : sines) {
    const std::uint32_t t = asin30(s);
    EXPECT_GE(sin30(t), s);
    if (t > 0) {
      EXPECT_LT(sin30(t - 1), s);
    }
  }
}

TEST(Fixed, ProductsOfTurnsStayUnitLengthAndCompose) {
  Quat30 q{kOne30, 0, 0, 0};
  const Vec3i z{0, 0, kOne30};
  const std::uint32_t step = (1u << 31) / 1000;  // half of 2 pi / 1000
  for (int i = 0; i < 1000; ++i) q = renormalise(multiply(axis_turn(z, step), q));
  std::int64_t square = 0;
  for (const std::int32_t c : q) square += static_cast<std::int64_t>(c) * c;
  EXPECT_NEAR(std::sqrt(static_cast<double>(square)), kOne30, 2.0);
  EXPECT_NEAR(q[0], -kOne30, 4000) << "a full turn changes the sign of the quaternion";
  EXPECT_NEAR(q[3], 0, 4000);
}

TEST(Fixed, ProductMatchesTheDefinitionInFloatingPoint) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto unit = [&] {
    double c[4], n = 0;
    for (double& v : c) {
      v = normal(random);
      n += v * v;
    }
    Quat30 q{};
    for (std::size_t i = 0; i < 4; ++i) q[i] = static_cast<std::int32_t>(std::floor(c[i] / std::sqrt(n) * kOne30));
    return q;
  };
  for (int i = 0; i < 1000; ++i) {
    const Quat30 a = unit(), b = unit(), p = multiply(a, b);
    const auto f = [](std::int32_t v) { return static_cast<double>(v) / kOne30; };
    EXPECT_NEAR(f(p[0]), f(a[0]) * f(b[0]) - f(a[1]) * f(b[1]) - f(a[2]) * f(b[2]) - f(a[3]) * f(b[3]), 1e-9);
    EXPECT_NEAR(f(p[1]), f(a[0]) * f(b[1]) + f(a[1]) * f(b[0]) + f(a[2]) * f(b[3]) - f(a[3]) * f(b[2]), 1e-9);
    const Quat30 one = multiply(a, conjugate(a));
    EXPECT_NEAR(one[0], kOne30, 8);
    EXPECT_NEAR(one[1], 0, 8);
  }
}

}  // namespace
}  // namespace tactus
