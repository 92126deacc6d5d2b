// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <tactus/metrics/past_frames.h>
#include "cli/report/network_report.h"

namespace tactus::sim {
class SessionNetwork;
class Simulation;
}  // namespace tactus::sim

namespace tactus::cli {

/// Judges the clients of a simulation with a network, tick by tick.
class NetworkJudge {
 public:
  NetworkJudge(const TraceInfo& info, const RigidTriggers& bounds);
  void add(const sim::Simulation& simulation);  ///< after each step
  /// One report per user, with what the sessions counted.
  std::vector<NetworkReport> finish(const sim::SessionNetwork& network);

 private:
  PastFrames past_;
  std::vector<NetworkReport> users_;
  std::vector<std::int64_t> judged_;  // last tick, of each user
};

}  // namespace tactus::cli
