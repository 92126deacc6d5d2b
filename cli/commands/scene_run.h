// SPDX-License-Identifier: Apache-2.0
/// Parts of simulations: recorded hands, and scenes for `tactus tolerable`.
#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include <tactus/metrics/delay_tolerance.h>
#include <tactus/sim/deformable/stiffness_map.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/simulation.h>
#include <tactus/trace/trace_file.h>
#include "cli/progress.h"
#include "cli/report/messages.h"

namespace tactus::cli {

// ==== replay ====
// A recording whose devices are played again.

/// A trace with users, a sample of each for every tick of a simulation.
tl::expected<TraceReader, Failure> open_replay(const std::string& path, Visibility progress);

/// One sample per user. If the recording has no buttons, button 0 counts as pressed during a spring contact.
std::vector<DeviceSample> recorded_devices(const TraceReader& recording, const TraceFrame& frame);

// ==== tolerable scene ====
// A scene in place of a recording: simulated without delay, with its virtual hands; and what its objects yield by.

class TolerableScene {
 public:
  /// Whether the argument of a command means a scene: a .toml file, or the name of one that comes with Tactus.
  static bool is_meant(const std::string& argument);
  /// err  of load_scene(), Simulation::create(), stiffness_map(); the scene has no users
  static tl::expected<TolerableScene, Failure> create(const std::string& name, std::uint64_t seed);

  TraceInfo info() const { return simulation_.info(); }
  std::int64_t ticks() const noexcept { return simulation_.ticks(); }
  /// The next tick; valid until the next call.   err  of Simulation::step
  tl::expected<const TraceFrame*, Failure> next();
  /// K: fraction of the device's displacement that what a user touches follows (thesis eq. 4.54); 1 for rigid objects.
  double follows(const DelayTolerance::Pair& pair, const UserSample& user) const noexcept;

 private:
  TolerableScene(std::string name, std::unique_ptr<sim::Scene> scene, sim::Simulation simulation,
                 std::vector<sim::StiffnessMap> maps)
      : name_(std::move(name)), scene_(std::move(scene)), simulation_(std::move(simulation)), maps_(std::move(maps)) {}

  std::string name_;
  std::unique_ptr<sim::Scene> scene_;
  sim::Simulation simulation_;
  std::vector<sim::StiffnessMap> maps_;  // one per deformable object
};

}  // namespace tactus::cli
