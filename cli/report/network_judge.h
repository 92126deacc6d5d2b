// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <tactus/metrics/past_frames.h>
#include <tactus/metrics/played_shapes.h>
#include "cli/options/options_codec.h"
#include "cli/report/network_report.h"

namespace tactus::sim {
class SessionNetwork;
class Simulation;
}  // namespace tactus::sim

namespace tactus::cli {

/// Judges the clients of a simulation with a network, tick by tick.
class NetworkJudge {
 public:
  /// in   triggers, meshes  with the bounds that are judged
  NetworkJudge(const TraceInfo& info, const TriggerArguments& triggers, const MeshArguments& meshes);
  void add(const sim::Simulation& simulation, sim::SessionNetwork& network);  ///< after each step
  /// One report per user, with what the sessions counted.
  std::vector<NetworkReport> finish(const sim::SessionNetwork& network);

 private:
  struct User {
    NetworkReport report;
    std::vector<PlayedShapes> shapes{};  // of each deformable object
    std::int64_t judged = -1;            // last tick
  };
  PastFrames past_;
  const TraceInfo& info_;
  std::vector<User> users_;
};

}  // namespace tactus::cli
