// SPDX-License-Identifier: Apache-2.0
#include "cli/figure/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <thread>
#include <utility>

namespace tactus::cli {
namespace {

/// Both ends of a pipe; none of them reaches a child unless it is put there.
class Pipe {
 public:
  Pipe() : open_(pipe2(ends_.data(), O_CLOEXEC) == 0) {}
  ~Pipe() {
    close_writer();
    if (open_) close(ends_[0]);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  bool is_open() const { return open_; }
  int reader() const { return ends_[0]; }
  int writer() const { return ends_[1]; }
  void close_writer() {
    if (open_ && ends_[1] >= 0) close(std::exchange(ends_[1], -1));
  }

 private:
  std::array<int, 2> ends_{-1, -1};
  bool open_;  // after ends_, which it fills
};

/// A text that a child can read: a file without a name, in memory.
class InputFile {
 public:
  explicit InputFile(const std::string& text) : file_(memfd_create("input", MFD_CLOEXEC)) {
    for (std::size_t at = 0; file_ >= 0 && at < text.size();) {
      const ssize_t written = write(file_, text.data() + at, text.size() - at);
      if (written > 0) at += static_cast<std::size_t>(written);
      else if (errno != EINTR) close_it();
    }
    if (file_ >= 0) lseek(file_, 0, SEEK_SET);
  }
  ~InputFile() { close_it(); }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  bool is_open() const { return file_ >= 0; }
  int reader() const { return file_; }

 private:
  void close_it() {
    if (file_ >= 0) close(std::exchange(file_, -1));
  }

  int file_;
};

class SpawnActions {
 public:
  SpawnActions() { posix_spawn_file_actions_init(&actions_); }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;

  void redirect(int stream, int from) { posix_spawn_file_actions_adddup2(&actions_, from, stream); }
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

using Clock = std::chrono::steady_clock;

/// [ms] for poll(); -1: for ever
int time_left(Clock::time_point deadline) {
  if (deadline == Clock::time_point::max()) return -1;
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
  return static_cast<int>(std::max<std::chrono::milliseconds::rep>(left.count(), 0));
}

/// Read both until both are at their end, whichever has something first.   out  false: the deadline came first
bool drain(const Pipe& first, std::string& into_first, const Pipe& second, std::string& into_second, Clock::time_point deadline) {
  std::array<pollfd, 2> watched{{{first.reader(), POLLIN, 0}, {second.reader(), POLLIN, 0}}};
  const std::array<std::string*, 2> into{&into_first, &into_second};
  std::array<char, 65536> buffer;
  while (watched[0].fd >= 0 || watched[1].fd >= 0) {
    const int ready = poll(watched.data(), watched.size(), time_left(deadline));
    if (ready == 0) return false;
    if (ready < 0 && errno != EINTR) return true;
    if (ready < 0) continue;
    for (std::size_t i = 0; i < watched.size(); ++i) {
      if (watched[i].fd < 0 || watched[i].revents == 0) continue;
      const ssize_t got = read(watched[i].fd, buffer.data(), buffer.size());
      if (got > 0) into[i]->append(buffer.data(), static_cast<std::size_t>(got));
      else if (got == 0 || errno != EINTR) watched[i].fd = -1;
    }
  }
  return true;
}

/// Until the child has ended.   out  its status; none: the deadline came first
std::optional<int> wait_for(pid_t child, Clock::time_point deadline) {
  const bool for_ever = deadline == Clock::time_point::max();
  int status = 0;
  while (true) {
    const pid_t ended = waitpid(child, &status, for_ever ? 0 : WNOHANG);
    if (ended == child) return status;
    if (ended < 0 && errno != EINTR) return status;
    if (ended == 0 && Clock::now() >= deadline) return std::nullopt;
    if (ended == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace

tl::expected<ChildResult, std::error_code> run_child(const std::vector<std::string>& arguments, const std::string& input,
                                                     std::optional<std::chrono::seconds> limit) {
  const auto deadline = limit ? Clock::now() + *limit : Clock::time_point::max();
  std::vector<char*> words;
  words.reserve(arguments.size() + 1);
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  const InputFile in(input);
  Pipe out, error;
  SpawnActions actions;
  actions.redirect(STDIN_FILENO, in.reader());
  actions.redirect(STDOUT_FILENO, out.writer());
  actions.redirect(STDERR_FILENO, error.writer());
  pid_t child = 0;
  const int failed = !in.is_open() || !out.is_open() || !error.is_open()
                         ? errno
                         : posix_spawnp(&child, words[0], actions.get(), nullptr, words.data(), environ);
  if (failed != 0) return tl::unexpected(std::error_code(failed, std::generic_category()));
  out.close_writer();
  error.close_writer();
  ChildResult result;
  std::optional<int> status;
  if (drain(out, result.out, error, result.error, deadline)) status = wait_for(child, deadline);
  if (!status) {
    kill(child, SIGKILL);
    wait_for(child, Clock::time_point::max());
    return tl::unexpected(std::make_error_code(std::errc::timed_out));
  }
  result.status = WIFEXITED(*status) ? WEXITSTATUS(*status) : 128 + WTERMSIG(*status);
  return result;
}

std::string own_program() {
  std::error_code ignored;
  return std::filesystem::read_symlink("/proc/self/exe", ignored).string();
}

}  // namespace tactus::cli
