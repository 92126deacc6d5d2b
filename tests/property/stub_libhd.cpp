// SPDX-License-Identifier: Apache-2.0
/// Stands in for the vendor's libHD.so: a handle that circles, called at 1 kHz, and a judge of how it is used.
#include "tests/property/stub_libhd.h"

#include <pthread.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <string>
#include <thread>

#include <tactus/device/openhaptics/hd_runtime.h>

namespace {

using tactus::device::openhaptics::ErrorRecord;
using tactus::device::openhaptics::Parameter;
using tactus::testing::StubState;

constexpr std::uint32_t kHandle = 7;
constexpr std::uint32_t kError = 0x0103;

std::mutex lock;
StubState state;
std::string failing;
std::uint64_t calls_left = 0;
std::uint32_t error = 0;
bool in_frame = false, has_output = false, spoils = false;
std::atomic<std::int64_t> pause_ns{0};
std::uint32_t (*task)(void*) = nullptr;
void* argument = nullptr;
std::uint64_t tick = 0;
std::atomic<bool> runs{false};
std::thread thread;

/// Whether this call is the one that fails.
bool fails(const char* function) {
  if (failing != function || calls_left == 0 || --calls_left > 0) return false;
  error = kError;
  return true;
}

void expect(bool is_right) { state.wrong_calls += is_right ? 0U : 1U; }

void run() {
  const sched_param first{.sched_priority = 85};  // as a vendor's thread has it, where it may
  pthread_setschedparam(pthread_self(), SCHED_FIFO, &first);
  auto due = std::chrono::steady_clock::now();
  while (runs) {
    due += std::chrono::milliseconds(1);
    if (const std::int64_t pause = pause_ns.exchange(0); pause > 0) {
      std::this_thread::sleep_for(std::chrono::nanoseconds(pause));
      due = std::chrono::steady_clock::now();
    }
    std::this_thread::sleep_until(due);
    std::uint32_t (*call)(void*) = nullptr;
    void* with = nullptr;
    {
      const std::scoped_lock hold(lock);
      ++tick;
      call = task;
      with = argument;
    }
    if (call != nullptr && call(with) == 0) {
      const std::scoped_lock hold(lock);
      task = nullptr;
    }
  }
}

}  // namespace

extern "C" {

void stub_reset() {
  const std::scoped_lock hold(lock);
  state = {};
  failing.clear();
  calls_left = 0;
  error = 0;
  spoils = in_frame = has_output = false;
}
void stub_fail(const char* function, std::uint64_t number) {
  const std::scoped_lock hold(lock);
  failing = function;
  calls_left = number;
}
void stub_spoil(bool on) {
  const std::scoped_lock hold(lock);
  spoils = on;
}
void stub_pause(std::int64_t nanoseconds) { pause_ns = nanoseconds; }
void stub_look(StubState* out) {
  const std::scoped_lock hold(lock);
  *out = state;
}

std::uint32_t hdInitDevice(const char* name) {
  const std::scoped_lock hold(lock);
  if (fails("hdInitDevice") || (name != nullptr && std::strcmp(name, "nobody") == 0)) {
    error = kError;
    return 0xffffffff;
  }
  const std::string number = std::to_string(0.5);  // as the vendor's runtime reads its own configuration
  expect(number[1] == '.');
  expect(!state.is_open);
  state.is_open = true;
  return kHandle;
}
void hdDisableDevice(std::uint32_t device) {
  const std::scoped_lock hold(lock);
  expect(device == kHandle && state.is_open && !state.is_running);
  state.is_open = has_output = false;
}
void hdMakeCurrentDevice(std::uint32_t device) {
  const std::scoped_lock hold(lock);
  fails("hdMakeCurrentDevice");
  expect(device == kHandle);
}
void hdBeginFrame(std::uint32_t device) {
  const std::scoped_lock hold(lock);
  fails("hdBeginFrame");
  expect(device == kHandle && !in_frame);
  in_frame = true;
}
void hdEndFrame(std::uint32_t device) {
  const std::scoped_lock hold(lock);
  fails("hdEndFrame");
  expect(device == kHandle && in_frame);
  in_frame = false;
  ++state.frames;
}
void hdEnable(std::uint32_t capability) {
  const std::scoped_lock hold(lock);
  if (fails("hdEnable")) return;
  expect(capability == 0x4000 && state.is_open);
  has_output = true;
}
void hdGetDoublev(Parameter parameter, double* out) {
  const std::scoped_lock hold(lock);
  fails("hdGetDoublev");
  const double angle = 0.001 * static_cast<double>(tick);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  switch (parameter) {
    case Parameter::max_force:
      *out = 3.3;
      return;
    case Parameter::position:  // the tick is given to a hundredth of a millimetre
      expect(in_frame);
      out[0] = spoils ? nan : 0.01 * static_cast<double>(tick % 10'000);
      out[1] = 20;
      out[2] = -30;
      return;
    case Parameter::velocity:
      expect(in_frame);
      out[0] = 10;
      out[1] = out[2] = 0;
      return;
    case Parameter::transform: {  // a turn about the runtime's "up"
      expect(in_frame);
      const double c = std::cos(angle), s = std::sin(angle);
      const double turn[16] = {c, 0, -s, 0, 0, 1, 0, 0, s, 0, c, 0, 0, 20, -30, 1};
      std::memcpy(out, turn, sizeof turn);
      return;
    }
    default:
      expect(false);
  }
}
void hdGetIntegerv(Parameter parameter, int* out) {
  const std::scoped_lock hold(lock);
  fails("hdGetIntegerv");
  expect(parameter == Parameter::rate || (parameter == Parameter::buttons && in_frame));
  *out = parameter == Parameter::rate ? 1000 : static_cast<int>(tick / 4 % 2);
}
const char* hdGetString(Parameter parameter) {
  const std::scoped_lock hold(lock);
  expect(parameter == Parameter::serial);
  return fails("hdGetString") ? nullptr : "00-11";
}
void hdSetDoublev(Parameter parameter, const double* values) {
  const std::scoped_lock hold(lock);
  expect(parameter == Parameter::force && in_frame && has_output);
  if (fails("hdSetDoublev")) return;
  std::memcpy(state.force, values, sizeof state.force);
  if (values[0] != 0 || values[1] != 0 || values[2] != 0) ++state.pushes;
}
void hdStartScheduler() {
  {
    const std::scoped_lock hold(lock);
    if (fails("hdStartScheduler")) return;
    expect(!state.is_running);
    state.is_running = true;
  }
  runs = true;
  thread = std::thread(run);
}
void hdStopScheduler() {
  runs = false;
  if (thread.joinable()) thread.join();
  const std::scoped_lock hold(lock);
  state.is_running = false;
}
unsigned long hdScheduleAsynchronous(std::uint32_t (*callback)(void*), void* data, unsigned short) {
  const std::scoped_lock hold(lock);
  if (fails("hdScheduleAsynchronous")) return 0;
  task = callback;
  argument = data;
  return 1;
}
void hdUnschedule(unsigned long) {
  const std::scoped_lock hold(lock);
  task = nullptr;
}
ErrorRecord hdGetError() {
  const std::scoped_lock hold(lock);
  const ErrorRecord out{error, 0, kHandle};
  error = 0;
  return out;
}
const char* hdGetErrorString(std::uint32_t code) { return code == kError ? "device fault" : ""; }

}  // extern "C"
