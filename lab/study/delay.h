// SPDX-License-Identifier: Apache-2.0
/// What users of a scene feel behind a network that delays: with clients that make up for it and with clients that do not, beside the
/// same scene without delay (thesis 4.1, 4.2.4 and 4.3.4). All of it is deterministic.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tactus/base/diagnostic.h>
#include <tactus/sim/link/link.h>
#include <tactus/sim/scene/scene.h>

namespace tactus::sim::study {

/// Devices of all users, tick by tick.
using DevicePaths = std::vector<std::vector<DeviceSample>>;

struct DelayCase {
  LinkOptions link{};  ///< there and back, but for the seed
  std::optional<SceneCompensation> compensation{};
  const Scene* own = nullptr;          ///< what clients simulate, if they do so and it is not the scene
  bool is_local = false;               ///< no network at all: the reference
  const DevicePaths* paths = nullptr;  ///< instead of the hands, which feel the force
  std::uint64_t seed = 1;
};

/// A user's tick.
struct DelayTick {
  double client = 0, server = 0;  ///< [N] magnitude of the force
  double stiffness = 0;           ///< [N/m] of the client's spring; 0: nothing is touched
  double round_trip = 0;          ///< [s] age of what is shown, as an answer to the device; 0 without a network
  std::optional<Vec3> touched{};  ///< [m] where the client shows the point of the surface that the device touches
  Pose shown;                     ///< of the object that the user looks at, at the client
  double energy = 0;              ///< [J] put into the environment by the device since it was last free for 0.1 s
};

struct DelayRun {
  std::vector<std::vector<DelayTick>> users;
  DevicePaths paths;  ///< of the devices
};

/// Every update is sent in every tick, shown as soon as it is there: only the delay differs.
/// err  of Simulation
tl::expected<DelayRun, Diagnostic> run_delayed(const Scene& scene, const DelayCase& one);

/// A user's force against what it would be without delay.
struct DelayEffect {
  double mean = 0, reference_mean = 0;  ///< [N] over the contact of either
  double peak = 0, reference_peak = 0;  ///< [N] 99th percentile of it
  double outside = 0;                   ///< fraction of the reference's contact in which the force is more than `weber` off
  double rms = 0;                       ///< RMS of the error over RMS of the reference; nan: there is no reference
  double lowest_energy = 0;             ///< [J] least of the run
};

/// The value that a fraction of them does not exceed; nan: there are none.   in  values  put into another order
double quantile(std::vector<double>& values, double fraction);

/// pre  of the same scene and length
DelayEffect effect_of(const std::vector<DelayTick>& delayed, const std::vector<DelayTick>& reference, double weber);

}  // namespace tactus::sim::study
