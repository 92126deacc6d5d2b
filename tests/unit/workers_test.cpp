// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/workers.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>
#include <new>

namespace tactus::cli {
namespace {

std::ptrdiff_t open_files() { return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {}); }

TEST(Workers, HoldOnlyTheirOwnEndOfThePipe) {
  const std::ptrdiff_t before = open_files();
  const auto held = run_in_workers<std::ptrdiff_t>(
      4, [](std::size_t) { return open_files(); }, [](std::size_t) {});
  ASSERT_TRUE(held);
  for (const std::ptrdiff_t files : *held) EXPECT_EQ(files, before + 1);
}

TEST(Workers, OfOneThatDiesNothingIsReturned) {
  const auto none = run_in_workers<int>(
      2, [](std::size_t i) -> int { return i == 0 ? 1 : throw std::bad_alloc(); }, [](std::size_t) {});
  EXPECT_FALSE(none);
}

}  // namespace
}  // namespace tactus::cli
