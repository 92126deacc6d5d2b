// SPDX-License-Identifier: Apache-2.0
/// A device at work: its loop, its guard, and what a person sees of both.
#pragma once

#include <termios.h>
#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/device/force_guard.h>
#include <tactus/device/real_time.h>
#include <tactus/device/servo.h>
#include <tactus/trace/trace_recorder.h>
#include "cli/live/rendered.h"
#include "cli/options/options_codec.h"
#include "cli/report/messages.h"

namespace tactus::cli {

// ==== guard report ====
// What the guard of a device did to the forces of a run.

struct Value;

struct GuardReport {
  std::array<std::uint64_t, device::kGuardActions> ticks{};  ///< changed, per device::GuardAction
  std::vector<device::GuardEntry> log{};                     ///< actions that began; time since the run began
  double energy = 0;                                         ///< [J] that the hand was given
  std::uint64_t halted = 0;                                  ///< times that the loop hung
};

/// in   begin  of the run
/// out  none: the device takes no force
std::optional<GuardReport> guard_report(device::Servo& servo, device::Time begin);

Value value_of(const GuardReport& report);

// ==== keyboard ====

/// Keys as they are pressed, without Enter, where standard input is a terminal; nothing elsewhere, or in the background.
class Keyboard {
 public:
  Keyboard() noexcept;
  ~Keyboard();  ///< the terminal is as it was before
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  bool is_there() const noexcept { return before_.has_value(); }
  std::optional<char> pressed() noexcept;  ///< the next key that waits; never blocks

 private:
  std::optional<termios> before_;
};

// ==== device loop ====
// The thread of a device: sample, what the hand feels, force, trace, 1000 times per second. What it does between two ticks allocates
// nothing, waits for no file and prints nothing.

struct DevicePlan {
  std::string path{}, shown_path{};  ///< of the trace: to write to, and to name in messages; empty: none
  std::string command{}, backend{}, subject{}, remarks{};
  device::ServoOptions servo{};
  double duration = 0;  ///< [s] 0: until stop() or the end of a recording
};

class DeviceLoop {
 public:
  DeviceLoop(const DevicePlan& plan, device::Device& device, Rendered& rendered)
      : plan_(plan), device_(device), rendered_(rendered) {}

  /// On a thread of its own; ODE and real-time scheduling belong to it.
  Outcome run();
  void stop() noexcept { stops_ = true; }

  /// From another thread.
  struct Now {
    std::uint64_t ticks = 0, missed = 0, lost = 0;
    double force = 0;        ///< [N]
    device::Time worst = 0;  ///< [ns] latest tick since the last call
    device::Reading::State state{};
  };
  Now now() noexcept;
  void mark(std::string_view text);  ///< nothing before the first tick

  /// After run().
  struct Outcomes {
    device::ServoTimes times{};
    std::uint64_t ticks = 0, missed = 0;  ///< offered to the recorder; left out before them
    std::optional<GuardReport> guard{};
    TraceRecorder::Status recorder{};
    std::uint64_t device_lost = 0;
    std::uint64_t reports = 0;  ///< of a device that has no position
    std::string privileges;
    std::int64_t last_tick = -1;
    double largest_force = 0;  ///< [N]
  };
  const Outcomes& outcomes() const noexcept { return outcomes_; }

 private:
  Outcome set_up();
  TraceInfo describe() const;
  Outcome go_on(device::Servo& servo);
  Outcome tick(device::Servo& servo, const device::ServoTick& tick);
  void publish(const device::ServoTick& tick, double force) noexcept;
  void conclude(device::Servo& servo);
  tl::unexpected<Failure> device_failed(const Error& error) const;

  const DevicePlan& plan_;
  device::Device& device_;
  Rendered& rendered_;
  std::optional<TraceRecorder> recorder_;
  std::atomic<TraceRecorder*> shared_recorder_{nullptr};
  TraceFrame frame_;
  device::Time begin_ = 0;  // of the first tick
  Outcomes outcomes_;

  std::atomic<bool> stops_{false};
  std::atomic<std::uint64_t> ticks_{0}, missed_{0}, lost_{0};
  std::atomic<double> force_{0};
  std::atomic<device::Time> worst_{0};
  std::atomic<device::Reading::State> state_{device::Reading::State::valid};
};

// ==== device report ====
// What a person sees while a device runs and afterwards, whatever was rendered.

/// Run the loop on a thread of its own until it ends. Keys become markers, q and a signal end it, and a meter shows how it goes.
Outcome run_attended(DeviceLoop& loop, const CommonOptions& common);

/// After run_attended().
struct DeviceRun {
  const device::Capabilities& device;
  const DeviceLoop::Outcomes& outcomes;
  const std::string& trace;  ///< as typed; empty: none
  double rate = 0;           ///< [Hz]

  double seconds() const { return static_cast<double>(outcomes.last_tick + 1) / rate; }
  std::uint64_t lost() const { return outcomes.recorder.lost + outcomes.device_lost; }
};
/// Adds what there is to say of every run: `trace` to `privileges`, and `guard` of a device that takes a force.
void add_to(Value& report, const DeviceRun& run);
/// A failure, and what the trace holds after it.
tl::unexpected<Failure> failed(Failure failure, const DeviceRun& run);
/// err  a sample was lost
Outcome check_complete(const DeviceRun& run);

}  // namespace tactus::cli
