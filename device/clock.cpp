// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/clock.h>

#include <cerrno>
#include <ctime>

namespace tactus::device {
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

}  // namespace tactus::device
