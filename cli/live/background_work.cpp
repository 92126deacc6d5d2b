// SPDX-License-Identifier: Apache-2.0
#include "cli/live/background_work.h"

#include <pthread.h>
#include <sched.h>

#include <utility>

namespace tactus::cli {

BackgroundWork::~BackgroundWork() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  news_.notify_one();
  thread_.join();
}

void BackgroundWork::give(SessionServer::Work work) {
  {
    const std::lock_guard lock(mutex_);
    asked_.push_back(std::move(work));
  }
  news_.notify_one();
}

void BackgroundWork::free(SessionServer::Work work) {
  {
    const std::lock_guard lock(mutex_);
    freed_.push_back(std::move(work));
  }
  news_.notify_one();
}

std::optional<SessionServer::Work> BackgroundWork::poll() {
  if (ready_.load(std::memory_order_acquire) == 0) return std::nullopt;
  const std::lock_guard lock(mutex_);
  ready_.fetch_sub(1, std::memory_order_relaxed);
  std::optional<SessionServer::Work> out(std::move(done_.back()));
  done_.pop_back();
  return out;
}

void BackgroundWork::run() {
  const sched_param usual{};
  pthread_setschedparam(pthread_self(), SCHED_OTHER, &usual);  // not that of the thread of the ticks
  std::unique_lock lock(mutex_);
  while (true) {
    news_.wait(lock, [this] { return ends_ || !asked_.empty() || !freed_.empty(); });
    if (ends_) return;
    std::vector<SessionServer::Work> asked = std::exchange(asked_, {}), freed = std::exchange(freed_, {});
    lock.unlock();
    freed.clear();
    for (SessionServer::Work& work : asked) {
      work.run();
      const std::lock_guard done(mutex_);
      done_.push_back(std::move(work));
      ready_.fetch_add(1, std::memory_order_release);
    }
    lock.lock();
  }
}

}  // namespace tactus::cli
