// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/displacement.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace tactus {
namespace {

std::string rule_of(float value, unsigned position_exp) {
  std::array<std::array<std::int32_t, 3>, 1> out;
  const auto done = to_grid(std::vector<float>{0, value, 0}, position_exp, out);
  return done ? "" : done.error().rule;
}

TEST(Displacement, GoesToTheNearestPlaceAndBack) {
  const std::vector<float> metres{0.1f, -0.1f, 0, 0.5f, -0.5f, 1e-9f};
  std::array<std::array<std::int32_t, 3>, 2> grid;
  ASSERT_TRUE(to_grid(metres, 20, grid));
  for (std::size_t i = 0; i < metres.size(); ++i) {
    const Vec3 shown = to_metres(grid[i / 3], 20);
    EXPECT_LE(std::abs(std::array{shown.x, shown.y, shown.z}[i % 3] - static_cast<double>(metres[i])), std::ldexp(0.5, -20));
  }
}

TEST(Displacement, RefusesWhatTheGridCannotHold) {
  EXPECT_EQ(rule_of(std::numeric_limits<float>::quiet_NaN(), 22), "R-API-1");
  EXPECT_EQ(rule_of(-std::numeric_limits<float>::infinity(), 22), "R-API-1");
  EXPECT_EQ(rule_of(32, 22), "");  // 2^27 units
  EXPECT_EQ(rule_of(32.1f, 22), "R-API-2");
  EXPECT_EQ(rule_of(-1e30f, 22), "R-API-2");
  std::array<std::array<std::int32_t, 3>, 2> more;
  EXPECT_STREQ(to_grid(std::vector<float>{0, 0, 0}, 22, more).error().rule, "R-API-5");
}

}  // namespace
}  // namespace tactus
