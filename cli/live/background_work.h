// SPDX-License-Identifier: Apache-2.0
/// What takes a server longer than a tick, on a thread of its own.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include <tactus/session/session_server.h>

namespace tactus::cli {

/// The thread sleeps while there is nothing, and has no real-time priority. Threads: one, that of the server, may call it.
class BackgroundWork {
 public:
  BackgroundWork() : thread_([this] { run(); }) {}
  ~BackgroundWork();
  BackgroundWork(const BackgroundWork&) = delete;
  BackgroundWork& operator=(const BackgroundWork&) = delete;

  void give(SessionServer::Work work);
  void free(SessionServer::Work work);  ///< it is not needed any more
  /// That is done. While nothing is, no lock is taken.
  std::optional<SessionServer::Work> poll();

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable news_;
  std::vector<SessionServer::Work> asked_, freed_, done_;
  std::atomic<std::size_t> ready_{0};  // of those that are done
  bool ends_ = false;
  std::thread thread_;  // the last: it uses the others
};

}  // namespace tactus::cli
