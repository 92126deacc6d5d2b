// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/main_state.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace tactus {
namespace {

TEST(ModeMotion, WithoutAPacketNothingIsExpected) {
  std::array<std::int32_t, 2> out{1, 1};
  ModeMotion(2).predict(3, out);
  EXPECT_EQ(out, (std::array<std::int32_t, 2>{}));
}

TEST(ModeMotion, LearnsAnOscillation) {
  ModeMotion motion(1);
  const auto increment = [](int frame) { return static_cast<std::int32_t>(std::lround(20000 * std::cos(1.0 * frame))); };
  for (int frame = 0; frame < 100; ++frame) motion.update(1, std::array{increment(frame)});
  std::int64_t error = 0, size = 0;  // of the next frame, learning on
  for (int frame = 100; frame < 200; ++frame) {
    std::array<std::int32_t, 1> next{};
    motion.predict(1, next);
    error += std::abs(next[0] - increment(frame));
    size += std::abs(increment(frame));
    motion.update(1, std::array{increment(frame)});
  }
  EXPECT_LT(20 * error, size);
}

TEST(ModeMotion, StopsWhenPacketsStayAway) {
  ModeMotion motion(1);
  for (int packet = 0; packet < 20; ++packet) motion.update(1, std::array{1000});
  std::array<std::int32_t, 1> last{}, later{};
  motion.predict(ModeMotion::kMaxSteps, last);
  motion.predict(1000, later);
  EXPECT_GT(last[0], 4000);
  EXPECT_EQ(later, last);
}

TEST(ModeMotion, ExtremeIncrementsStayInRange) {
  ModeMotion motion(1);
  for (int packet = 0; packet < 100; ++packet) {
    const std::int32_t limit =
        packet % 3 == 0 ? std::numeric_limits<std::int32_t>::min() : std::numeric_limits<std::int32_t>::max();
    motion.update(static_cast<std::uint32_t>(packet % 4), std::array{limit});
    std::array<std::int32_t, 1> out{};
    motion.predict(8, out);
    EXPECT_LE(std::abs(std::int64_t{out[0]}), 1 << 27);
  }
}

}  // namespace
}  // namespace tactus
