// SPDX-License-Identifier: Apache-2.0
#include "cli/figure/child_process.h"

#include <gtest/gtest.h>

namespace tactus::cli {
namespace {

TEST(ChildProcess, GivesBackWhatItPrintsAndHowItEnds) {
  const auto ended = run_child({"sh", "-c", "echo out; echo error >&2; exit 3"});
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->out, "out\n");
  EXPECT_EQ(ended->error, "error\n");
  EXPECT_EQ(ended->status, 3);
}

TEST(ChildProcess, ArgumentsAreNoProgram) {
  const auto ended = run_child({"echo", "$(touch here) `id` 'a' \"b\"; exit 1"});
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->out, "$(touch here) `id` 'a' \"b\"; exit 1\n");
}

TEST(ChildProcess, ReadsItsInput) {
  std::string text(300000, 'x');  // more than a pipe holds
  text += '\n';
  const auto ended = run_child({"cat"}, text);
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->out, text);
  const auto nothing = run_child({"cat"});
  ASSERT_TRUE(nothing);
  EXPECT_EQ(nothing->out, "");
}

/// So does a gnuplot that a figure makes wait for ever.
TEST(ChildProcess, IsKilledAfterItsLimit) {
  for (const char* command :
       {"sleep 1000", "while :; do :; done", "trap '' TERM; while :; do :; done", "exec >&- 2>&-; sleep 1000"}) {
    const auto ended = run_child({"sh", "-c", command}, {}, std::chrono::seconds(1));
    ASSERT_FALSE(ended) << command;
    EXPECT_EQ(ended.error(), std::errc::timed_out) << command;
  }
}

TEST(ChildProcess, WhatIsNotThereIsSaid) {
  const auto ended = run_child({"a-program-that-is-not-there"});
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error(), std::errc::no_such_file_or_directory);
}

}  // namespace
}  // namespace tactus::cli
