// SPDX-License-Identifier: Apache-2.0
/// Independent jobs on all cores, each worker a process of its own: ODE keeps one random generator per process, so two worlds that
/// step at the same time in one process would disturb each other and a seed would no longer name one result.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <string_view>
#include <thread>
#include <type_traits>
#include <vector>

#include <tactus/base/result.h>

namespace tactus::cli {

/// What went wrong in a job, small and flat.
struct FlatError {
  bool failed = false;
  Errc code = Errc::internal;
  char rule[16] = {};
  std::int64_t tick = 0;

  static FlatError of(const Error& error, std::int64_t tick) {
    FlatError out{.failed = true, .code = error.code, .rule = {}, .tick = tick};
    const std::string_view rule = error.rule;
    std::copy_n(rule.begin(), std::min(rule.size(), sizeof out.rule - 1), out.rule);
    return out;
  }
  /// Valid as long as this is.
  Error error() const { return {code, rule, 0}; }
};

/// Job i yields job(i), for i below `count`; `on_done` is told how many are ready. Nothing when a worker died.
/// pre  no thread is running; job writes no files and prints nothing.
template <class Value, class Job, class OnDone>
std::optional<std::vector<Value>> run_in_workers(std::size_t count, Job&& job, OnDone&& on_done) {
  static_assert(std::is_trivially_copyable_v<Value>);
  struct Message {
    std::size_t index;
    Value value;
  };
  static_assert(sizeof(Message) <= 512, "a pipe passes so much in one piece (POSIX PIPE_BUF)");
  int pipe_ends[2];
  if (pipe(pipe_ends) != 0) return std::nullopt;
  const std::size_t workers = std::min<std::size_t>(count, std::max(1u, std::thread::hardware_concurrency()));
  std::vector<pid_t> children;
  for (std::size_t worker = 0; worker < workers; ++worker) {
    const pid_t child = fork();
    if (child == 0) {
      close(pipe_ends[0]);  // a worker whose reader is gone is to end, not to wait for room in the pipe
      try {
        for (std::size_t i = worker; i < count; i += workers) {
          const Message message{i, job(i)};
          if (write(pipe_ends[1], &message, sizeof message) != static_cast<ssize_t>(sizeof message)) _exit(1);
        }
        _exit(0);
      } catch (const std::exception&) {  // nothing of the parent's is undone here
        _exit(1);
      }
    }
    if (child > 0) children.push_back(child);
  }
  close(pipe_ends[1]);
  std::vector<Value> values(count);
  std::size_t done = 0;
  Message message;
  while (read(pipe_ends[0], &message, sizeof message) == static_cast<ssize_t>(sizeof message)) {
    values[message.index] = message.value;
    on_done(++done);
  }
  close(pipe_ends[0]);
  for (const pid_t child : children) waitpid(child, nullptr, 0);
  return done == count ? std::optional(std::move(values)) : std::nullopt;
}

}  // namespace tactus::cli
