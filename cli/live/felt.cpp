// SPDX-License-Identifier: Apache-2.0
#include "cli/live/felt.h"

namespace tactus::cli {

TraceInfo FeltNothing::info() const {
  TraceInfo info;
  info.users.push_back({.name = "hand", .forces = KnownForces::felt});
  return info;
}

tl::expected<Vec3, Failure> FeltNothing::step(const device::ServoTick& tick, TraceFrame& frame) {
  frame.users.front().device = tick.reading.sample;
  return Vec3{};
}

}  // namespace tactus::cli
