// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/guardian.h>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <climits>
#include <csignal>
#include <exception>
#include <new>

#include <tactus/base/rule.h>

namespace tactus::device {
namespace {

constexpr int kLine = 3;  // behind the standard ones

/// Signals are blocked as long as this lives, so that none ends a new process ahead of its work.
class BlockedSignals {
 public:
  BlockedSignals() noexcept {
    sigset_t all{};
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~BlockedSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_{};
};

/// Alone: no descriptor but the line, no terminal.
void leave(int line) noexcept {
  setsid();
  const int nothing = open("/dev/null", O_RDWR);
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nothing, number);
  dup2(line, kLine);
  close_range(kLine + 1, UINT_MAX, 0);
}

/// Wait for a byte from the other side; false: that has ended.
bool hears(int line) noexcept {
  char word = 0;
  ssize_t size = 0;
  do size = read(line, &word, 1);
  while (size < 0 && errno == EINTR);
  return size > 0;
}

bool notify(int line) noexcept {
  const char word = 1;
  ssize_t size = 0;
  do size = send(line, &word, 1, MSG_NOSIGNAL);
  while (size < 0 && errno == EINTR);
  return size > 0;
}

[[noreturn]] void guard(int line, const std::function<void()>& last_act) noexcept {
  leave(line);
  if (notify(kLine) && !hears(kLine)) {
    try {
      last_act();
    } catch (const std::exception&) {
      _exit(1);
    }
  }
  _exit(0);
}

}  // namespace

Result<std::unique_ptr<Guardian>> Guardian::start(const std::function<void()>& last_act) try {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return out_of_memory();
  const BlockedSignals blocked;
  const pid_t process = fork();
  if (process == 0) guard(ends[0], last_act);
  close(ends[0]);
  if (process < 0) {
    close(ends[1]);
    return out_of_memory();
  }
  std::unique_ptr<Guardian> guardian(new Guardian(process, ends[1]));
  if (!hears(ends[1])) return out_of_memory();  // until it stands alone, what ends us would end it, too
  return guardian;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Guardian::~Guardian() {
  static_cast<void>(notify(line_));  // it may have been ended
  close(line_);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

}  // namespace tactus::device
