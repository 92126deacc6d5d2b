// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/real_time.h>

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>
#include <cerrno>
#include <cstdint>
#include <ctime>

namespace tactus::device {

// ==== clock ====

namespace {

constexpr Time kSecond = 1000 * kMillisecond;

class MonotonicClock final : public Clock {
 public:
  Time now() noexcept override {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    return time.tv_sec * kSecond + time.tv_nsec;
  }
  void sleep_until(Time time) noexcept override {
    const timespec until{time / kSecond, time % kSecond};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
  }
};

}  // namespace

Clock& monotonic_clock() noexcept {
  static MonotonicClock clock;
  return clock;
}

// ==== real time ====

namespace {

constexpr int kPriority = 80;  // of 1..99: above interrupts' threads (50), below the kernel's own

/// Under a limit, memory that is locked in advance would fail to grow later.
bool may_lock_all() noexcept {
  rlimit limit{};
  return geteuid() == 0 || (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY);
}

}  // namespace

RealTime::RealTime() : latency_(open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC)) {
  sched_param parameters{};
  pthread_getschedparam(pthread_self(), &policy_, &parameters);
  priority_ = parameters.sched_priority;
  parameters.sched_priority = kPriority;
  const bool is_first = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) == 0;
  privileges_.push_back({"real-time priority", is_first,
                         is_first ? "" : "allow it: `ulimit -r 80`, or the line `@audio - rtprio 80` in /etc/security/limits.d"});
  const bool is_locked = may_lock_all() && mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0;  // not what is only reserved
  privileges_.push_back(
      {"memory locked", is_locked,
       is_locked ? "" : "allow it: `ulimit -l unlimited`, or `@audio - memlock unlimited` in /etc/security/limits.d"});
  constexpr std::int32_t kNoLatency = 0;  // [us]
  const bool is_awake = latency_ >= 0 && write(latency_, &kNoLatency, sizeof kNoLatency) == sizeof kNoLatency;
  privileges_.push_back({"no deep sleep", is_awake, is_awake ? "" : "allow writing to /dev/cpu_dma_latency"});
}

RealTime::~RealTime() {
  if (latency_ >= 0) close(latency_);
  if (privileges_[1].granted) munlockall();
  const sched_param parameters{.sched_priority = priority_};
  if (privileges_[0].granted) pthread_setschedparam(pthread_self(), policy_, &parameters);
}

std::string RealTime::granted() const {
  std::string text;
  for (const Privilege& privilege : privileges_)
    if (privilege.granted) text.append(text.empty() ? "" : ", ").append(privilege.name);
  return text.empty() ? "none" : text;
}

}  // namespace tactus::device
