// SPDX-License-Identifier: Apache-2.0
/// The thread of a device: sample, what the hand feels, force, trace, 1000 times per second. What it does between two ticks allocates
/// nothing, waits for no file and prints nothing.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <tactus/device/force_guard.h>
#include <tactus/device/real_time.h>
#include <tactus/device/servo.h>
#include <tactus/trace/trace_recorder.h>
#include "cli/live/felt.h"
#include "cli/live/guard_report.h"
#include "cli/report/messages.h"

namespace tactus::cli {

struct DevicePlan {
  std::string path{}, shown_path{};  ///< of the trace: to write to, and to name in messages; empty: none
  std::string command{}, backend{}, subject{}, remarks{};
  device::ServoOptions servo{};
  double duration = 0;  ///< [s] 0: until stop() or the end of a recording
};

class DeviceLoop {
 public:
  DeviceLoop(const DevicePlan& plan, device::Device& device, Felt& felt) : plan_(plan), device_(device), felt_(felt) {}

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
    std::uint64_t reports = 0;  ///< of a device that has no place
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
  void publish(const device::ServoTick& tick) noexcept;
  void conclude(device::Servo& servo);
  tl::unexpected<Failure> device_failed(const Error& error) const;

  const DevicePlan& plan_;
  device::Device& device_;
  Felt& felt_;
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

}  // namespace tactus::cli
