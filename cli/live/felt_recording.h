// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <tactus/device/recording.h>
#include "cli/live/felt.h"

namespace tactus::cli {

enum class Exerted : std::uint8_t {
  nothing,
  force,  ///< what the hand of the recording felt
  path,   ///< a spring draws the hand to where that of the recording was
};

/// A recording, played from the first sample on that the device has of its hand; both hands begin at the same place. The trace is in the
/// recording's frame.
class FeltRecording final : public Felt {
 public:
  /// in   stiffness  [N/m] of the spring
  FeltRecording(device::Recording recording, Exerted exerted, double stiffness);

  TraceInfo info() const override;
  tl::expected<Vec3, Failure> step(const device::ServoTick& tick, TraceFrame& frame) override;
  bool is_over() const noexcept override { return is_over_; }

  /// How far the hands were from each other [m].
  struct Distance {
    double mean = 0, largest = 0;
  };
  Distance distance() const noexcept;

 private:
  Vec3 spring(const Vec3& way, const Vec3& hand, device::Time into, device::Time now) noexcept;

  device::Recording recording_;
  Exerted exerted_;
  double stiffness_;
  device::Time begin_ = -1;  // of the recording
  bool is_over_ = false;
  Vec3 origin_{};                 // [m] of the device's frame in the recording's
  Vec3 place_{}, speed_{};        // [m], [m/s] of the hand at the tick before; the speed is smoothed
  device::Time placed_ = 0;       // when the hand was there
  double sum_ = 0, largest_ = 0;  // [m]
  std::uint64_t ticks_ = 0;
};

}  // namespace tactus::cli
