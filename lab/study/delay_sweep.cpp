// SPDX-License-Identifier: Apache-2.0
#include "lab/study/delay_sweep.h"

#include <algorithm>
#include <cmath>

namespace tactus::sim::study {
namespace {

constexpr double kWeber = 0.1, kWrong = 1.1;

LinkOptions link_of(const DelayPoint& point) {
  LinkOptions out{.delay = point.round_trip / 2};
  out.seed = point.seed;
  if (!point.varies) return out;
  out.delay = out.gamma_mean = point.round_trip / 4;
  out.gamma_deviation = 2 * out.gamma_mean / 3;
  out.gamma_piece = 500'000;
  return out;
}

/// What clients take for the scene who know it badly.
Scene misread(const Scene& scene) {
  Scene out = scene;
  for (SceneObject& object : out.objects) {
    object.mass *= kWrong;
    object.friction *= kWrong;
  }
  for (SceneMsd& object : out.msds) object.object.stiffness *= kWrong;
  for (SceneDeformable& object : out.deformables)
    for (SceneMaterial& material : object.materials) material.young *= kWrong;
  return out;
}

/// [m] Where the touched point is shown, from where it would be without delay, while it is touched in both.
std::vector<double> seen_away(const std::vector<DelayTick>& delayed, const std::vector<DelayTick>& reference) {
  std::vector<double> out;
  for (std::size_t i = 0; i < reference.size(); ++i)
    if (delayed[i].touched && reference[i].touched) out.push_back(norm(*delayed[i].touched - *reference[i].touched));
  return out;
}

/// [m] Where the other user sees what this one looks at, if both look at the same.
std::vector<double> seen_apart(const Scene& scene, const DelayRun& run) {
  std::vector<double> out;
  if (scene.users.size() < 2 || scene.users[0].object != scene.users[1].object) return out;
  if (scene.users[0].object >= scene.objects.size() + scene.msds.size()) return out;  // its shape is seen, not its position
  for (std::size_t i = 0; i < run.users[0].size(); ++i)
    out.push_back(norm(run.users[0][i].shown.position - run.users[1][i].shown.position));
  return out;
}

double rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return values.empty() ? NAN : std::sqrt(sum / static_cast<double>(values.size()));
}

double over(double value, double reference) { return reference > 0 ? value / reference - 1 : NAN; }

DelayNumbers numbers(const DelayEffect& rendered, const DelayEffect& played, std::vector<double> away,
                     std::vector<double> apart) {
  return {.mean = static_cast<float>(over(rendered.mean, rendered.reference_mean)),
          .peak = static_cast<float>(over(rendered.peak, rendered.reference_peak)),
          .outside = static_cast<float>(rendered.outside),
          .energy = static_cast<float>(rendered.lowest_energy),
          .force_error = static_cast<float>(played.rms),
          .seen = static_cast<float>(rms(away)),
          .most_seen = static_cast<float>(quantile(away, 0.95)),
          .apart = static_cast<float>(quantile(apart, 0.95))};
}

}  // namespace

const char* name(Clients clients) noexcept {
  constexpr std::array kNames{"none", "stiffness", "stiffness-thesis", "simulation", "simulation, 10 % off"};
  return kNames[static_cast<std::size_t>(clients)];
}

tl::expected<DelayResult, Diagnostic> run_point(const Scene& scene, const DelayPoint& point) {
  TACTUS_TRY(const DelayRun reference, run_delayed(scene, {.is_local = true, .seed = point.seed}));
  const Scene wrong = misread(scene);
  DelayResult out{};
  for (std::size_t c = 0; c < kClients.size(); ++c) {
    DelayCase one{.link = link_of(point), .seed = point.seed};
    if (kClients[c] == Clients::stiffness) one.compensation.emplace();
    if (kClients[c] == Clients::printed) one.compensation = SceneCompensation{.method = CompensationMethod::stiffness_thesis};
    if (kClients[c] >= Clients::simulation) one.compensation = SceneCompensation{.method = CompensationMethod::simulation};
    if (kClients[c] == Clients::misled) one.own = &wrong;
    TACTUS_TRY(const DelayRun rendered, run_delayed(scene, one));
    one.paths = &reference.paths;
    TACTUS_TRY(const DelayRun played, run_delayed(scene, one));
    for (std::size_t i = 0; i < scene.users.size(); ++i)
      out[c][i] = numbers(effect_of(rendered.users[i], reference.users[i], kWeber),
                          effect_of(played.users[i], reference.users[i], kWeber), seen_away(played.users[i], reference.users[i]),
                          seen_apart(scene, played));
  }
  return out;
}

}  // namespace tactus::sim::study
