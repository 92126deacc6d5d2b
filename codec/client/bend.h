// SPDX-License-Identifier: Apache-2.0
/// The way of an object between two updates when a packet between them is missing. spec/60-client.md section 7. Internal to the library.
#pragma once

#include <cstdint>

#include <tactus/rigid/rigid_predictor.h>
#include <tactus/rigid/rigid_state.h>

namespace tactus {

/// A cubic that leaves `a` and meets `b` with their velocities; a straight line where these are 0.
/// Its error grows with the fourth power of the time between, that of dead reckoning with the second.
/// pre  a.tick <= tick <= b.tick, a.tick < b.tick, b.tick - a.tick <= max_extrapolation.   time about 0.5 us, no allocation.
RigidPose bend(const Scene& scene, const RigidState& a, const RigidState& b, std::int64_t tick) noexcept;

}  // namespace tactus
