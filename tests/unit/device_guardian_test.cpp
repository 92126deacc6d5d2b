// SPDX-License-Identifier: Apache-2.0
/// The process that lets a device go when ours has ended.
#include <gtest/gtest.h>

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include <tactus/device/guardian.h>
#include "tests/unit/temp_file.h"

namespace tactus::device {
namespace {

/// A file whose being there says that the last act was done.
class Act {
 public:
  Act() { std::filesystem::remove(file_.path()); }
  std::function<void()> last_act() const {
    return [path = file_.path()] { std::ofstream(path) << "done"; };
  }
  bool is_done() const { return std::filesystem::exists(file_.path()); }
  bool comes() const {
    for (int i = 0; i < 5000 && !is_done(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return is_done();
  }

 private:
  TempFile file_;
};

/// A process that has a guardian and ends in this way.
void end_by(const Act& act, const std::function<void()>& end) {
  const pid_t process = fork();
  if (process == 0) {
    const auto guardian = Guardian::start(act.last_act());
    if (guardian) end();
    _exit(1);
  }
  waitpid(process, nullptr, 0);
}

TEST(Guardian, ActsWhenItsProcessIsKilled) {
  const Act act;
  end_by(act, [] { kill(getpid(), SIGKILL); });
  EXPECT_TRUE(act.comes());
}

/// As who stops a command and all that it started.
TEST(Guardian, ActsWhenTheGroupOfItsProcessIsKilled) {
  const Act act;
  const pid_t process = fork();
  if (process == 0) {
    setpgid(0, 0);
    const auto guardian = Guardian::start(act.last_act());
    if (guardian) kill(0, SIGKILL);
    _exit(1);
  }
  waitpid(process, nullptr, 0);
  EXPECT_TRUE(act.comes());
}

TEST(Guardian, ActsWhenItsProcessEndsWithoutGoodbye) {
  const Act act;
  end_by(act, [] { _exit(0); });
  EXPECT_TRUE(act.comes());
}

TEST(Guardian, DoesNothingAfterAGoodbye) {
  const Act act;
  Guardian::start(act.last_act()).value().reset();  // has ended when this is done
  EXPECT_FALSE(act.is_done());
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "a process is left";
}

TEST(Guardian, MayEndBeforeUs) {
  const Act act;
  auto guardian = Guardian::start(act.last_act()).value();
  pid_t process = 0;
  ASSERT_TRUE(std::ifstream("/proc/thread-self/children") >> process);
  kill(process, SIGKILL);
  guardian.reset();
  EXPECT_FALSE(act.is_done());
}

TEST(Guardian, HoldsNothingOfOursOpen) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  const Act act;
  const auto guardian = Guardian::start(act.last_act()).value();
  close(ends[1]);
  pollfd hung{ends[0], POLLIN, 0};
  EXPECT_EQ(poll(&hung, 1, 5000), 1);
  EXPECT_NE(hung.revents & POLLHUP, 0);
  close(ends[0]);
}

TEST(Guardian, OneDoesNotKeepAnotherFromActing) {
  const Act first, second;
  end_by(first, [&] {
    const auto other = Guardian::start(second.last_act());
    kill(getpid(), SIGKILL);
  });
  EXPECT_TRUE(first.comes());
  EXPECT_TRUE(second.comes());
}

TEST(Guardian, SignalsOfOurTerminalDoNotEndIt) {
  const Act act;
  const pid_t process = fork();
  if (process == 0) {
    setpgid(0, 0);  // the guardian would be of this group
    const auto guardian = Guardian::start(act.last_act());
    kill(0, SIGINT);
    _exit(1);
  }
  waitpid(process, nullptr, 0);
  EXPECT_TRUE(act.comes());
}

}  // namespace
}  // namespace tactus::device
