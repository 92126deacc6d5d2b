// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/servo.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <system_error>

#include <tactus/base/rule.h>

namespace tactus::device {
namespace {

constexpr double kUsualRate = 1000, kMostRate = 10'000;  // [Hz]
constexpr Time kTimeout = 15 * kMillisecond;             // of the thread that watches, which looks each kLook
constexpr Time kLook = 4 * kMillisecond;

}  // namespace

Result<std::unique_ptr<Servo>> Servo::start(Device& device, const ServoOptions& options, Clock& clock) try {
  const Capabilities& can = device.capabilities();
  const double own = can.rate > 0 ? can.rate : kUsualRate;
  const double rate = options.rate == 0 ? own : options.rate;
  if (!(rate >= 1 && rate <= kMostRate)) return fail(Errc::invalid_argument, "R-API-4");
  std::optional<ForceGuard> guard;
  if (can.force_axes > 0) {
    TACTUS_TRY(guard, ForceGuard::create(can, options.limits));
  }
  const auto period = static_cast<Time>(std::llround(1e9 / rate));
  return std::unique_ptr<Servo>(new Servo(device, clock, period, guard));
} catch (const std::bad_alloc&) {
  return out_of_memory();
} catch (const std::system_error&) {
  return out_of_memory();
}

Servo::Servo(Device& device, Clock& clock, Time period, const std::optional<ForceGuard>& guard)
    : device_(device), clock_(clock), period_(period), guard_(guard) {
  if (guard_) watcher_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
}

Servo::~Servo() {
  release();  // first: the other thread may sleep
  watcher_ = {};
}

/// Zero force, whatever the device answers.
void Servo::release() noexcept {
  if (!guard_) return;
  acts_.store(false, std::memory_order_relaxed);
  if (!device_.write(guard_->stop())) device_.halt();
}

void Servo::watch(const std::stop_token& stop) noexcept {
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(std::chrono::nanoseconds(kLook));
    const Time now = clock_.now();  // first: this thread may be held up between the two
    const bool is_late = now - exerted_.load(std::memory_order_acquire) > kTimeout;
    if (!is_late || !acts_.load(std::memory_order_acquire) || is_halted_.exchange(true)) continue;
    halted_.fetch_add(1, std::memory_order_relaxed);  // first: who feels the halt may ask
    device_.halt();
  }
}

/// For our own clock: the tick after the last one, or the newest whose time has come.
void Servo::wait() noexcept {
  if (!has_begun_) {
    tick_.due = clock_.now();
    late_ = 0;
    return;
  }
  tick_.due += period_;
  clock_.sleep_until(tick_.due);
  const Time late = std::max<Time>(clock_.now() - tick_.due, 0);
  const Time whole = late / period_;
  tick_.missed = static_cast<std::uint32_t>(std::min<Time>(whole, UINT32_MAX));
  tick_.due += whole * period_;
  tick_.number += 1 + whole;
  late_ = late;
}

Result<ServoTick> Servo::next() noexcept {
  const bool has_clock = device_.capabilities().has_clock;
  tick_.missed = 0;
  if (!has_clock) wait();
  const auto reading = device_.read(has_clock ? clock_.now() + kAnswerTime : tick_.due);
  if (!reading) {
    release();
    return tl::unexpected(reading.error());
  }
  begun_ = clock_.now();
  tick_.reading = *reading;
  if (has_clock) {
    tick_.due = reading->taken;
    tick_.missed = has_begun_ ? reading->lost : 0;
    tick_.number += has_begun_ ? 1 + static_cast<std::int64_t>(tick_.missed) : 0;
  }
  has_begun_ = true;
  tick_.lateness = has_clock ? std::max<Time>(begun_ - tick_.due, 0) : late_;
  tick_.age = std::max<Time>(begun_ - reading->taken, 0);
  ++times_.ticks;
  times_.missed += tick_.missed;
  times_.lateness.add(tick_.lateness);
  times_.age.add(tick_.age);
  return tick_;
}

Result<void> Servo::exert(const Vec3& force) noexcept {
  if (guard_) {
    if (is_halted_.load(std::memory_order_acquire)) {
      (void)guard_->stop();  // starts from zero again
      is_halted_.store(false, std::memory_order_release);
    }
    const Time now = clock_.now();
    const GuardedForce passed = guard_->pass({force, tick_.reading.taken}, tick_.reading, now);
    exerted_.store(now, std::memory_order_release);
    acts_.store(passed.value() != Vec3{}, std::memory_order_release);
    if (const auto written = device_.write(passed); !written) {
      release();
      return written;
    }
  }
  times_.busy.add(clock_.now() - begun_);
  return {};
}

const ServoTimes& Servo::times() noexcept {
  times_.halted = halted_.load(std::memory_order_relaxed);
  return times_;
}

}  // namespace tactus::device
