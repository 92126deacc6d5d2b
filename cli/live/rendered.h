// SPDX-License-Identifier: Apache-2.0
/// What is rendered to the hand on a device: nothing, a scene, a recording.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <tl/expected.hpp>

#include <tactus/device/recording.h>
#include <tactus/device/servo.h>
#include <tactus/sim/simulation.h>
#include <tactus/trace/frame.h>
#include "cli/live/device_choice.h"
#include "cli/report/messages.h"

namespace tactus::cli {

// ==== rendered ====

/// What is rendered to the hand on a device, tick by tick, and what a trace says of it.
class Rendered {
 public:
  /// Set-up, on the thread that then calls step().
  virtual Outcome begin() { return {}; }
  /// Of the trace, after begin(). The device that is used stands in for that of user().
  virtual TraceInfo info() const = 0;
  virtual std::size_t user() const noexcept { return 0; }

  /// The force [N] to render at the probe, which moves scale() times as far as the device: the device exerts force / scale().
  /// out  frame  all that the trace holds of this tick, but its number, what was exerted, and how the servo kept its time
  /// time at most 1 ms on average; no allocation
  virtual tl::expected<Vec3, Failure> step(const device::ServoTick& tick, TraceFrame& frame) = 0;
  virtual double scale() const noexcept { return 1; }
  virtual bool is_over() const noexcept { return false; }

  virtual ~Rendered() = default;
};

/// Motion alone.
class RenderedNothing final : public Rendered {
 public:
  TraceInfo info() const override;
  tl::expected<Vec3, Failure> step(const device::ServoTick& tick, TraceFrame& frame) override;
};

// ==== rendered recording ====

enum class Exerted : std::uint8_t {
  nothing,
  force,  ///< what was rendered to the hand of the recording
  path,   ///< a spring draws the hand to where that of the recording was
};

/// A recording, played from the first sample on that the device has of its hand; both hands begin at the same position. The trace is in the
/// recording's frame, whose probe moves `scale` times as far as the device.
class RenderedRecording final : public Rendered {
 public:
  /// in   stiffness  [N/m] of the spring
  RenderedRecording(device::Recording recording, Exerted exerted, double stiffness, double scale);

  TraceInfo info() const override;
  tl::expected<Vec3, Failure> step(const device::ServoTick& tick, TraceFrame& frame) override;
  double scale() const noexcept override { return frame_.scale; }
  bool is_over() const noexcept override { return is_over_; }

  /// How far the hands were from each other [m].
  struct Distance {
    double mean = 0, largest = 0;
  };
  Distance distance() const noexcept;

 private:
  Vec3 spring(const Vec3& displacement, const Vec3& hand, device::Time into, device::Time now) noexcept;

  device::Recording recording_;
  Exerted exerted_;
  double stiffness_;
  device::Time begin_ = -1;  // of the recording
  bool is_over_ = false;
  DeviceFrame frame_;             // in the recording's
  Vec3 position_{}, speed_{};     // [m], [m/s] of the hand at the tick before; the speed is smoothed
  device::Time position_at_ = 0;  // when the hand was there
  double sum_ = 0, largest_ = 0;  // [m]
  std::uint64_t ticks_ = 0;
};

// ==== rendered scene ====

/// A scene, simulated here, that one of its users touches by the device; the others have virtual hands.
class RenderedScene final : public Rendered {
 public:
  /// in   scene, device  outlive it
  RenderedScene(const sim::Scene& scene, std::size_t user, std::uint64_t seed, const ChosenDevice& device);

  Outcome begin() override;
  TraceInfo info() const override { return simulation_->info(); }
  std::size_t user() const noexcept override { return user_; }
  tl::expected<Vec3, Failure> step(const device::ServoTick& tick, TraceFrame& frame) override;
  double scale() const noexcept override { return frame_.scale; }

 private:
  void show() noexcept;

  const sim::Scene& scene_;
  std::size_t user_;
  std::uint64_t seed_;
  VirtualDevice* hand_;
  DeviceFrame frame_;
  std::optional<sim::Simulation> simulation_;
};

}  // namespace tactus::cli
