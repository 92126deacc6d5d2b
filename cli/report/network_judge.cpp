// SPDX-License-Identifier: Apache-2.0
#include "cli/report/network_judge.h"

#include <utility>

#include <tactus/sim/link/session_network.h>
#include <tactus/sim/simulation.h>

namespace tactus::cli {
namespace {

constexpr std::size_t kKept = 4096;  // [ticks] of truth: more than any client lags behind

}  // namespace

NetworkJudge::NetworkJudge(const TraceInfo& info, const RigidTriggers& bounds) : past_(kKept) {
  for (const TraceUser& user : info.users) users_.push_back({.user = user.name, .errors = ErrorMetrics(info, bounds)});
  judged_.assign(users_.size(), -1);
}

void NetworkJudge::add(const sim::Simulation& simulation) {
  const TraceFrame& now = simulation.frame();
  past_.add(now);
  for (std::size_t i = 0; i < users_.size(); ++i) {
    NetworkReport& user = users_[i];
    if (simulation.share_rendered(i) < 1) ++user.without_force;
    const TraceFrame* const truth = past_.at(simulation.shown_tick(i));
    if (truth == nullptr) {
      ++user.not_shown;
      continue;
    }
    if (std::exchange(judged_[i], truth->tick) < truth->tick) user.errors.add(*truth, simulation.client_poses(i));
    user.delay_sum += 1e-3 * static_cast<double>(now.tick - truth->tick);
    ++user.shown;
  }
}

std::vector<NetworkReport> NetworkJudge::finish(const sim::SessionNetwork& network) {
  const auto direction = [](const Traffic& traffic, const sim::LinkCounters& link) {
    return DirectionReport{.traffic = traffic,
                           .sent = link.sent,
                           .lost = link.lost + link.cut + link.overflowed,
                           .duplicated = link.duplicated,
                           .overtaken = link.overtaken};
  };
  for (std::size_t i = 0; i < users_.size(); ++i) {
    users_[i].status = network.status(i);
    users_[i].up = direction(network.sent_by(i), network.uplink(i));
    users_[i].down = direction(network.sent_to(i), network.downlink(i));
  }
  return std::move(users_);
}

}  // namespace tactus::cli
