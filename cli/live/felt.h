// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <tl/expected.hpp>

#include <tactus/device/servo.h>
#include <tactus/trace/frame.h>
#include "cli/report/messages.h"

namespace tactus::cli {

/// What the hand on a device feels, tick by tick, and what a trace says of it.
class Felt {
 public:
  /// Set-up, on the thread that then calls step().
  virtual Outcome begin() { return {}; }
  /// Of the trace, after begin(). The device that is used stands in for that of user().
  virtual TraceInfo info() const = 0;
  virtual std::size_t user() const noexcept { return 0; }

  /// The force [N] that the hand should feel.
  /// out  frame  all that the trace holds of this tick, but its number, what was exerted, and how the servo kept its time
  /// time at most 1 ms on average; no allocation
  virtual tl::expected<Vec3, Failure> step(const device::ServoTick& tick, TraceFrame& frame) = 0;
  virtual bool is_over() const noexcept { return false; }

  virtual ~Felt() = default;
};

/// Motion alone.
class FeltNothing final : public Felt {
 public:
  TraceInfo info() const override;
  tl::expected<Vec3, Failure> step(const device::ServoTick& tick, TraceFrame& frame) override;
};

}  // namespace tactus::cli
