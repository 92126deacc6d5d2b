// SPDX-License-Identifier: Apache-2.0
#include "cli/options/headings.h"

#include <gtest/gtest.h>

#include <vector>

namespace tactus::cli {
namespace {

const std::vector<std::string> kNames{"encode", "decode", "sim", "serve", "--quiet"};

TEST(Suggestion, OneSlipIsSeen) {
  for (const char* typed : {"encod", "encodee", "enocde", "encide"})
    EXPECT_EQ(did_you_mean(typed, kNames), ". Did you mean encode?") << typed;
  EXPECT_EQ(did_you_mean("smi", kNames), ". Did you mean sim?");
  EXPECT_EQ(did_you_mean("--quit", kNames), ". Did you mean --quiet?");
}

TEST(Suggestion, WhatIsFarFromEveryNameSuggestsNothing) {
  for (const std::string& typed : {std::string("juggle"), std::string(), std::string("s"), std::string(100000, 'e')})
    EXPECT_EQ(did_you_mean(typed, kNames), "");
  EXPECT_EQ(did_you_mean("encode", {}), "");
}

}  // namespace
}  // namespace tactus::cli
