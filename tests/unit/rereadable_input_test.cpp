// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/input.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>
#include <string_view>

namespace tactus::cli {
namespace {

constexpr std::string_view kText = "once";

/// What remains of a pipe, whose writer is gone.
class Pipe {
 public:
  Pipe() {
    int ends[2]{};
    EXPECT_EQ(pipe(ends), 0);
    EXPECT_EQ(write(ends[1], kText.data(), kText.size()), static_cast<ssize_t>(kText.size()));
    close(ends[1]);
    end_ = ends[0];
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() { close(end_); }
  std::string path() const { return "/proc/self/fd/" + std::to_string(end_); }

 private:
  int end_ = -1;
};

TEST(RereadableInput, APipeIsReadAgainAndAgain) {
  const Pipe pipe;
  const auto input = RereadableInput::open(pipe.path(), kText.size());
  ASSERT_TRUE(input);
  for (int i = 0; i < 2; ++i) EXPECT_EQ(read_file(input->path()), std::string(kText));
}

TEST(RereadableInput, APipeLongerThanTheLimitIsRefused) {
  const Pipe pipe;
  EXPECT_FALSE(RereadableInput::open(pipe.path(), kText.size() - 1));
  const auto endless = RereadableInput::open("/dev/zero", 1 << 20);
  ASSERT_FALSE(endless);
  EXPECT_EQ(endless.error().text, "/dev/zero: more than 1 MiB from a pipe");
}

}  // namespace
}  // namespace tactus::cli
