// SPDX-License-Identifier: Apache-2.0
/// The shape of an object as the device of a client makes it, for the codec of deformable objects (elastic/driven_shape.h has it). An
/// interface, so that a program that knows no device links nothing of elastic bodies. Internal to the library.
#pragma once

#include <cstdint>
#include <span>

#include <tactus/deformable/main_state.h>

namespace tactus {

class FollowedShape {
 public:
  virtual ~FollowedShape() = default;

  /// What a state shows that follows the device: the shape at a tick, and what the state differed by from the shape at its own, or what is
  /// left of it.   out  false: one of the two is not known, and nothing is written
  virtual bool show(const MainState& state, std::int64_t tick, std::span<Vec3i> shown) noexcept = 0;
  /// The shape alone, on the grid.   out  false: it is not known
  virtual bool body_at(std::int64_t tick, std::span<Vec3i> shape) noexcept = 0;
  /// Go on to this tick. To be called at each shape that is not shown either: who is more than 64 behind begins anew at rest.
  virtual void follow(std::int64_t tick) noexcept = 0;
};

}  // namespace tactus
