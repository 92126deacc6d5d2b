// SPDX-License-Identifier: Apache-2.0
#include "cli/report/report.h"

#include <gtest/gtest.h>

#include <thread>

namespace tactus::cli {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(StepTimes, StepsOfManySecondsAreWhole) {
  StepTimes times;
  for (const std::int64_t seconds : {7, 90, 20'000}) times.add({seconds * kSecond, 2 * seconds * kSecond});
  EXPECT_DOUBLE_EQ(times.quantile(TimeOf::wall, 0.5), 90);
  EXPECT_DOUBLE_EQ(times.quantile(TimeOf::wall, 1), 20'000);
  EXPECT_DOUBLE_EQ(times.quantile(TimeOf::cpu, 0), 14);
  EXPECT_DOUBLE_EQ(times.total(TimeOf::wall), 20'097);
  EXPECT_DOUBLE_EQ(times.total(TimeOf::cpu), 40'194);
}

TEST(StepTimes, WaitingTakesWallTimeButNoCpuTime) {
  using namespace std::chrono_literals;
  StepTimes times;
  times.measure([] { return std::this_thread::sleep_for(50ms), 0; });
  EXPECT_GE(times.total(TimeOf::wall), 0.05);
  EXPECT_LT(times.total(TimeOf::cpu), 0.05);
}

TEST(StepTimes, WorkOfEveryThreadTakesCpuTime) {
  StepTimes times;
  times.measure([] {
    std::thread([] {
      timespec used{};
      while (used.tv_nsec < 10'000'000) clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
    }).join();
    return 0;
  });
  EXPECT_GE(times.total(TimeOf::cpu), 0.01);
}

}  // namespace
}  // namespace tactus::cli
