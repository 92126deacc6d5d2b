// SPDX-License-Identifier: Apache-2.0
/// What a tick of a device costs, and how long a force lasts after the last command, for each way in which a program can fail.
#include <benchmark/benchmark.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/device/guardian.h>
#include <tactus/device/servo.h>
#include <tactus/trace/trace_file.h>
#include <tactus/trace/trace_recorder.h>

namespace tactus::device {
namespace {

constexpr Time kPeriod = kMillisecond;
constexpr int kFailures = 200;

/// Takes every force, and notes when it became zero.
class NotingDevice final : public Device {
 public:
  const Capabilities& capabilities() const noexcept override { return can_; }
  Result<Reading> read(Time deadline) noexcept override {
    if (is_gone) return fail(Errc::io, "R-DEV-4");
    return Reading{.taken = deadline};
  }
  Result<void> write(const GuardedForce& force) noexcept override {
    if (force.value() == Vec3{}) note();
    else rested = 0;
    return {};
  }
  void halt() noexcept override { note(); }

  std::atomic<Time> rested{0};
  bool is_gone = false;

 private:
  void note() noexcept {
    Time none = 0;
    rested.compare_exchange_strong(none, monotonic_clock().now());
  }
  Capabilities can_{.name = "noting", .force_axes = 3, .nominal_force = 3, .rate = 1000};
};

/// Time does not pass by waiting.
class HastyClock final : public Clock {
 public:
  Time now() noexcept override { return now_; }
  void sleep_until(Time time) noexcept override { now_ = time; }

 private:
  std::atomic<Time> now_{kMillisecond};
};

void Guard(benchmark::State& state) {
  NotingDevice device;
  GuardLimits limits;
  limits.passivity = true;
  ForceGuard guard = ForceGuard::create(device.capabilities(), limits).value();
  Reading reading;
  Time now = 0;
  for (auto _ : state) {
    now += kPeriod;
    reading.sample.position.x = 1e-6 * static_cast<double>(now % 1000);
    benchmark::DoNotOptimize(guard.pass({{1, 0.5, 0.1}, now}, reading, now));
  }
}
BENCHMARK(Guard);

void tick_servo(benchmark::State& state) {
  NotingDevice device;
  HastyClock clock;
  const auto servo = Servo::start(device, {}, clock).value();
  for (auto _ : state) {
    benchmark::DoNotOptimize(servo->next());
    benchmark::DoNotOptimize(servo->exert({1, 0, 0}));
  }
}
BENCHMARK(tick_servo);

/// What a capture of motion alone writes, and that many bytes of reports each tick.
class Captured {
 public:
  explicit Captured(std::size_t reports) {
    info.users.push_back({.name = "hand", .senses = {.velocity = true, .time = true}, .has_servo = true});
    info.capture.emplace();
    frame.users.resize(1);
    if (reports == 0) return;
    info.users[0].report_descriptor.emplace();
    frame.users[0].reports = {{static_cast<std::uint32_t>(reports)}, std::vector<std::uint8_t>(reports)};
  }
  ~Captured() { std::filesystem::remove(path); }
  Captured(const Captured&) = delete;
  Captured& operator=(const Captured&) = delete;

  void move_to(const ServoTick& tick) {
    UserSample& user = frame.users[0];
    frame.tick = tick.number;
    user.device = tick.reading.sample;
    user.device.position.x = 1e-7 * static_cast<double>(tick.number % 100'003);
    user.device.time = tick.reading.taken;
    user.servo = {tick.lateness, tick.age, tick.missed, 0};
    if (!user.reports.bytes.empty()) user.reports.bytes[0] = static_cast<std::uint8_t>(tick.number);
  }
  double bytes_per_tick() const {
    return static_cast<double>(std::filesystem::file_size(path)) / static_cast<double>(frame.tick + 1);
  }

  const std::string path = std::filesystem::temp_directory_path() / ("tactus_device_bench." + std::to_string(getpid()));
  TraceInfo info;
  TraceFrame frame;
};

/// From the device to the ring of the thread that writes.   in  range(0) [bytes] of reports
void capture_tick(benchmark::State& state) {
  constexpr std::int64_t kWait = 2048;  // ticks; the ring holds twice as many
  NotingDevice device;
  HastyClock clock;
  Captured captured(static_cast<std::size_t>(state.range(0)));
  auto recorder = TraceRecorder::create(captured.path, captured.info, captured.frame).value();
  {
    const auto servo = Servo::start(device, {}, clock).value();
    for (auto _ : state) {
      const auto tick = servo->next();
      static_cast<void>(servo->exert({1, 0, 0}));
      captured.move_to(*tick);
      recorder.offer(captured.frame);
      if (tick->number % kWait != kWait - 1) continue;
      state.PauseTiming();
      while (recorder.status().last_written < tick->number) std::this_thread::sleep_for(std::chrono::microseconds(200));
      state.ResumeTiming();
    }
  }
  state.counters["lost"] = static_cast<double>(recorder.status().lost);
  if (!recorder.finish()) state.SkipWithError("the trace cannot be written");
}
BENCHMARK(capture_tick)->Arg(0)->Arg(64);

/// What the writing thread does with a tick.   in  range(0) [bytes] of reports
void capture_write(benchmark::State& state) {
  Captured captured(static_cast<std::size_t>(state.range(0)));
  auto writer = TraceWriter::create(captured.path, captured.info, {.chunk_time = 0.08}).value();
  ServoTick tick;
  for (auto _ : state) {
    captured.move_to(tick);
    benchmark::DoNotOptimize(writer.write(captured.frame));
    ++tick.number;
  }
  if (!writer.finish()) return state.SkipWithError("the trace cannot be written");
  state.counters["bytes_per_tick"] = captured.bytes_per_tick();
}
BENCHMARK(capture_write)->Arg(0)->Arg(64);

/// A loop that pushes for 20 ms.
std::unique_ptr<Servo> pushing(NotingDevice& device) {
  auto servo = Servo::start(device, {}).value();
  for (int tick = 0; tick < 20; ++tick) {
    static_cast<void>(servo->next());
    static_cast<void>(servo->exert({1, 0, 0}));
  }
  return servo;
}

Time rested(const NotingDevice& device) {
  while (device.rested == 0) std::this_thread::sleep_for(std::chrono::microseconds(50));
  return device.rested;
}

void report(benchmark::State& state, std::vector<Time>& times) {
  std::ranges::sort(times);
  const auto ms = [&](std::size_t index) { return 1e-6 * static_cast<double>(times[index]); };
  state.counters["p50_ms"] = ms(times.size() / 2);
  state.counters["p99_ms"] = ms(times.size() * 99 / 100);
  state.counters["max_ms"] = ms(times.size() - 1);
}

/// in   fail  lets a loop that just pushed fail; returns when that was
template <class Fail>
void measure(benchmark::State& state, Fail fail) {
  std::vector<Time> times;
  for (auto _ : state) {
    NotingDevice device;
    const Time begin = fail(device);
    times.push_back(rested(device) - begin);
    state.SetIterationTime(1e-9 * static_cast<double>(times.back()));
  }
  report(state, times);
}

void rest_after_hang(benchmark::State& state) {
  measure(state, [](NotingDevice& device) {
    const auto servo = pushing(device);
    const Time begin = monotonic_clock().now();
    static_cast<void>(rested(device));  // while the loop does nothing
    return begin;
  });
}

void rest_after_exception(benchmark::State& state) {
  measure(state, [](NotingDevice& device) {
    Time begin = 0;
    try {
      const auto servo = pushing(device);
      begin = monotonic_clock().now();
      throw std::runtime_error("of the scene");
    } catch (const std::runtime_error&) {
      return begin;
    }
  });
}

void rest_after_lost_device(benchmark::State& state) {
  measure(state, [](NotingDevice& device) {
    const auto servo = pushing(device);
    const Time begin = monotonic_clock().now();
    device.is_gone = true;
    static_cast<void>(servo->next());
    return begin;
  });
}

void rest_after_force_that_is_no_number(benchmark::State& state) {
  measure(state, [](NotingDevice& device) {
    const auto servo = pushing(device);
    const Time begin = monotonic_clock().now();
    while (device.rested == 0) {
      static_cast<void>(servo->next());
      static_cast<void>(servo->exert({std::numeric_limits<double>::quiet_NaN(), 0, 0}));
    }
    return begin;
  });
}

/// A process with a guardian, which writes to shared memory when it acted.
pid_t guarded_process(std::atomic<Time>& acted) {
  const pid_t process = fork();
  if (process != 0) return process;
  const auto guardian = Guardian::start([&acted] { acted = monotonic_clock().now(); });
  for (;;) pause();
}

/// Until the guardian acts; what it then does takes as long as the device needs to be opened.
void act_after_kill(benchmark::State& state) {
  void* const shared = mmap(nullptr, sizeof(std::atomic<Time>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) return state.SkipWithError("no shared memory");
  auto& acted = *new (shared) std::atomic<Time>(0);
  std::vector<Time> times;
  for (auto _ : state) {
    acted = 0;
    const pid_t process = guarded_process(acted);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    const Time begin = monotonic_clock().now();
    kill(process, SIGKILL);
    waitpid(process, nullptr, 0);
    while (acted == 0) std::this_thread::sleep_for(std::chrono::microseconds(50));
    times.push_back(acted - begin);
    state.SetIterationTime(1e-9 * static_cast<double>(times.back()));
  }
  munmap(shared, sizeof(std::atomic<Time>));
  report(state, times);
}

BENCHMARK(rest_after_hang)->Iterations(kFailures)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(rest_after_exception)->Iterations(kFailures)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(rest_after_lost_device)->Iterations(kFailures)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(rest_after_force_that_is_no_number)->Iterations(kFailures)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(act_after_kill)->Iterations(kFailures)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tactus::device
