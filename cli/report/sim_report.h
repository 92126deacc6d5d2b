// SPDX-License-Identifier: Apache-2.0
/// What only simulations report: how hands touched, and what clients showed over an emulated network.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tactus/metrics/past_frames.h>
#include <tactus/metrics/played_shapes.h>
#include "cli/options/options_codec.h"
#include "cli/report/report.h"

namespace tactus {
class Receiver;
}

namespace tactus::sim {
struct NetworkOptions;
struct RigidErrors;
struct Scene;
class SessionNetwork;
class Simulation;
}  // namespace tactus::sim

namespace tactus::cli {

// ==== touch report ====
// What a simulation was like at each hand, and where its numbers say more about sampling than about the scene.

struct Report;

/// One TouchReport for each user, and a warning for each that chatters, swings while it should hold still, feels far less than the server's force, presses a deformable object harder than eq. 4.38 allows at
/// the position of the largest force, or was held by a coupling that its device's smoothing makes swing.
/// in   has_network  the clients are behind one
void report_touches(const sim::Scene& scene, const sim::Simulation& simulation, bool has_network, Report& report);
/// Warns on standard error of two users at one object who simulate it at a distance where they may swing.
void warn_of_two(const sim::NetworkOptions& network, const sim::Scene& scene);

// ==== rigid report ====

/// What the simulation of rigid objects knows of its own error, and a warning for each that makes the trace doubtful. Nothing if none moves.
void report_rigid(const sim::Scene& scene, const sim::RigidErrors& errors, Report& report);
/// A failure if more than a twentieth of the steps with contacts were not solved.   in  scene  its file
Outcome check_contacts(const Report& report, const std::string& scene);

// ==== network judge ====

/// Judges the clients of a simulation with a network, tick by tick.
class NetworkJudge {
 public:
  /// in   triggers, meshes  with the bounds that are judged
  NetworkJudge(const TraceInfo& info, const sim::Scene& scene, const TriggerArguments& triggers, const MeshArguments& meshes);
  void add(const sim::Simulation& simulation, sim::SessionNetwork& network);  ///< after each step
  /// One report per user, with what the sessions counted.
  std::vector<NetworkReport> finish(const sim::SessionNetwork& network);

 private:
  struct User {
    NetworkReport report;
    std::vector<PlayedShapes> shapes{};  // of each deformable object
    std::int64_t judged = -1;            // last tick
  };
  std::span<const std::uint8_t> levels_at(Receiver* receiver, std::int64_t tick);

  bool compensates_;
  PastFrames past_;
  const TraceInfo& info_;
  std::vector<User> users_;
  std::vector<std::uint8_t> levels_;
};

}  // namespace tactus::cli
