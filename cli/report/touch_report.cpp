// SPDX-License-Identifier: Apache-2.0
#include "cli/report/touch_report.h"

#include <fmt/format.h>

#include <algorithm>

#include <tactus/sim/deformable/stiffness_map.h>
#include <tactus/sim/simulation.h>
#include "cli/report/report.h"

namespace tactus::cli {
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

}  // namespace tactus::cli
