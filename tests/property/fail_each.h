// SPDX-License-Identifier: Apache-2.0
/// Each allocation of an action fails once.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>

#include <tactus/base/result.h>
#include "tests/property/allocated.h"

namespace tactus::testing {

/// Runs `action` on a copy of `input` until it gets through; true once it does.
///   number  of the allocation that fails
template <class Input, class Action>
bool gets_through(const Input& input, Action& action, std::uint64_t number) {
  Input copy = input;
  fail_allocation(number);
  const auto result = action(std::move(copy));
  const bool done = failure_is_due();
  fail_allocation(0);
  EXPECT_EQ(result.has_value(), done) << "allocation " << number;
  if (!result) {
    EXPECT_EQ(result.error().code, Errc::limit_exceeded) << "allocation " << number;
    EXPECT_STREQ(result.error().rule, "R-API-11") << "allocation " << number;
  }
  return done;
}

/// Returns how many allocations there are.
template <class Input, class Action>
std::uint64_t fail_each(const Input& input, Action action) {
  for (std::uint64_t number = 1;; ++number) {
    const std::uint64_t before = live_blocks();
    const bool done = gets_through(input, action, number);
    EXPECT_EQ(live_blocks(), before) << "leaked by allocation " << number;
    if (done || ::testing::Test::HasFailure()) return number - 1;
  }
}

}  // namespace tactus::testing
