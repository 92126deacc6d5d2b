// SPDX-License-Identifier: Apache-2.0
/// Error against run time of rigid objects: how far a motion is from what is known of it, by parts of a tick and iterations.
#pragma once

#include <span>
#include <string>

#include <tactus/sim/rigid/rigid_world.h>

namespace tactus::sim::study {

/// A motion whose outcome is known, from a formula or from a run with 64 parts.
struct RigidMotion {
  const char* name;
  const char* title;
  const char* unit;                                                      ///< of the error
  double (*error)(const RigidEffort& effort, double& seconds_per_tick);  ///< infinity: the simulation stopped
};

std::span<const RigidMotion> rigid_motions() noexcept;

}  // namespace tactus::sim::study
