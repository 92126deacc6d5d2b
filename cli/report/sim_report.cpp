// SPDX-License-Identifier: Apache-2.0
#include "cli/report/sim_report.h"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include <tactus/sim/deformable/stiffness_map.h>
#include <tactus/sim/link/session_network.h>
#include <tactus/sim/simulation.h>
#include <tactus/trace/trace_scene.h>
#include "cli/report/report.h"

namespace tactus::cli {

// ==== touch report ====

namespace {

constexpr std::uint32_t kByHand = 10;  // contacts that a hand makes in a second: tapping ends at about seven

void warn_of_chatter(const TouchReport& touch, Report& report) {
  if (touch.most_in_a_second <= kByHand) return;
  report.warnings.push_back(
      fmt::format("{}: the contact chatters: it began {} times within a second. Forces and updates are artefacts of the sampling",
                  touch.user, touch.most_in_a_second));
}

void warn_of_sampling(const sim::Scene& scene, const sim::Simulation& simulation, std::size_t user, Report& report) {
  const double stiffness = simulation.touched(user).stiffest, bears = simulation.bears(user);
  if (stiffness <= bears) return;
  report.warnings.push_back(fmt::format(
      "{}: a coupling of {:.4g} N/m exceeds {:.4g} N/m, the stability limit of this hand with its device's filter at {} Hz "
      "on a rigid surface",
      scene.users[user].name, stiffness, bears, sim::kTickRate));
}

/// All who may press an object at once count (eq. 4.38).
void warn_of_deformation(const sim::Scene& scene, const SurfaceContact& hardest, Report& report) {
  const sim::SceneDeformable& object = scene.deformables[hardest.mesh];
  const double sum = static_cast<double>(scene.users.size()) * object.stiffness;
  const auto bears = sim::critical_stiffness(object, hardest);
  if (!bears || sum <= *bears) return;
  report.warnings.push_back(fmt::format(
      "{}: a total coupling of {:.4g} N/m exceeds {:.4g} N/m, the limit of thesis eq. 4.38 at one deformation every {:g} ms. The "
      "contact may become unstable: give a smaller rate or stiffness",
      object.name, sum, *bears, 1e3 * object.rate * sim::kTick));
}

}  // namespace

void report_touches(const sim::Scene& scene, const sim::Simulation& simulation, Report& report) {
  if (report.ticks.count() == 0) return;
  std::vector<bool> looked(scene.deformables.size());
  for (std::size_t i = 0; i < scene.users.size(); ++i) {
    const sim::TouchSummary& t = simulation.touched(i);
    report.touches.push_back({.user = scene.users[i].name,
                              .share = static_cast<double>(t.ticks) / static_cast<double>(report.ticks.count()),
                              .contacts = t.contacts,
                              .most_in_a_second = t.most_in_a_second,
                              .largest_force = t.largest_force,
                              .lowest_energy = t.lowest_energy});
    warn_of_chatter(report.touches.back(), report);
    warn_of_sampling(scene, simulation, i, report);
    if (!t.hardest || looked[t.hardest->mesh]) continue;
    looked[t.hardest->mesh] = true;
    warn_of_deformation(scene, *t.hardest, report);
  }
}

// ==== network judge ====

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
