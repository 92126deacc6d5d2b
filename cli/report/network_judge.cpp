// SPDX-License-Identifier: Apache-2.0
#include "cli/report/network_judge.h"

#include <utility>

#include <tactus/sim/link/session_network.h>
#include <tactus/sim/simulation.h>
#include <tactus/trace/trace_scene.h>

namespace tactus::cli {
namespace {

constexpr std::size_t kKept = 4096;  // [ticks] of truth: more than any client lags behind

}  // namespace

NetworkJudge::NetworkJudge(const TraceInfo& info, const TriggerArguments& triggers, const MeshArguments& meshes)
    : past_(kKept), info_(info) {
  for (const TraceUser& user : info.users) {
    users_.push_back({.report = {.user = user.name, .errors = ErrorMetrics(info, triggers.triggers())}});
    for (std::size_t i = 0; i < info.meshes.size(); ++i) {
      const TraceDeformable& mesh = info.meshes[i];
      DeformableErrors errors(mesh.rest, meshes.thresholds(triggers), meshes.rings(), GridExponents{}.position);
      const auto most = static_cast<std::size_t>(kKept / mesh.period) + 1;
      users_.back().shapes.emplace_back(i, std::move(errors), most);
    }
  }
}

void NetworkJudge::add(const sim::Simulation& simulation, sim::SessionNetwork& network) {
  const TraceFrame& now = simulation.frame();
  past_.add(now);
  for (std::size_t i = 0; i < users_.size(); ++i) {
    User& user = users_[i];
    NetworkReport& report = user.report;
    for (std::size_t m = 0; m < user.shapes.size(); ++m)
      if (now.meshes[m].updated) user.shapes[m].add(now.tick, now.meshes[m].displacements, touch_of(now, m));
    if (simulation.share_rendered(i) < 1) ++report.without_force;
    const TraceFrame* const truth = past_.at(simulation.shown_tick(i));
    if (truth == nullptr) {
      ++report.not_shown;
      continue;
    }
    for (PlayedShapes& shapes : user.shapes) shapes.look(network.client(i).receiver()->replica(), truth->tick);
    if (std::exchange(user.judged, truth->tick) < truth->tick) report.errors.add(*truth, simulation.received_poses(i));
    report.delay_sum += 1e-3 * static_cast<double>(now.tick - truth->tick);
    ++report.shown;
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
  std::vector<NetworkReport> out;
  for (std::size_t i = 0; i < users_.size(); ++i) {
    NetworkReport& report = out.emplace_back(std::move(users_[i].report));
    report.status = network.status(i);
    report.widened = network.widened(i);
    report.up = direction(network.sent_by(i), network.uplink(i));
    report.down = direction(network.sent_to(i), network.downlink(i));
    for (std::size_t m = 0; m < users_[i].shapes.size(); ++m)
      report.meshes.push_back({.name = info_.meshes[m].name,
                               .vertices = info_.meshes[m].rest.vertices.size(),
                               .fidelity = std::move(users_[i].shapes[m]).errors()});
  }
  return out;
}

}  // namespace tactus::cli
