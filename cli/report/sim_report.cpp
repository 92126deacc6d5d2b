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

constexpr double kCalms = 20;          // [N s/m] of damping, from which on two at one object were stable up to 150 ms
constexpr std::uint32_t kByHand = 10;  // contacts that a hand makes in a second: tapping ends at about seven

void warn_of_chatter(const TouchReport& touch, Report& report) {
  if (touch.most_in_a_second <= kByHand) return;
  report.warnings.push_back(
      fmt::format("{}: the contact chatters: it began {} times within a second. Forces and updates are artefacts of the sampling",
                  touch.user, touch.most_in_a_second));
}

void warn_of_sampling(const sim::Scene& scene, const sim::Simulation& simulation, std::size_t user, Report& report) {
  const double stiffness = simulation.touched(user).stiffest, tolerated = simulation.tolerated_stiffness(user);
  if (stiffness <= tolerated) return;
  report.warnings.push_back(fmt::format(
      "{}: a coupling of {:.4g} N/m exceeds {:.4g} N/m, the stability limit of this hand with its device's filter at {} Hz "
      "on a rigid surface",
      scene.users[user].name, stiffness, tolerated, sim::kTickRate));
}

/// All who may press an object at once count (eq. 4.38).
void warn_of_deformation(const sim::Scene& scene, const SurfaceContact& hardest, Report& report) {
  const sim::SceneDeformable& object = scene.deformables[hardest.mesh];
  const double sum = static_cast<double>(scene.users.size()) * object.stiffness;
  const auto tolerated = sim::critical_stiffness(object, hardest);
  if (!tolerated || sum <= *tolerated) return;
  report.warnings.push_back(fmt::format(
      "{}: a total coupling of {:.4g} N/m exceeds {:.4g} N/m, the limit of thesis eq. 4.38 at one deformation every {:g} ms. The "
      "contact may become unstable: give a smaller rate or stiffness",
      object.name, sum, *tolerated, 1e3 * object.rate * sim::kTick));
}

constexpr double kSwing = 0.7e-3;     // [m], above what tremor makes
constexpr double kTremors = 6;        // times its RMS
constexpr double kUnder = 0.5;        // of the server's force, less
constexpr double kUnderForce = 0.25;  // [N]

/// In 130 loops of one, two and four users at a cube with a tremor of 0.05 mm, what died away within a second swung by at most 0.95 mm, and
/// what did not by 1.3 mm and more. The least energy of the contacts does not distinguish them: -176 and -163 mJ in one that was stable,
/// -115 and -62 mJ in one that was not.
void warn_of_swing(const sim::Scene& scene, std::size_t user, const TouchReport& touch, bool has_network, Report& report) {
  if (touch.swing <= kSwing + kTremors * scene.users[user].tremor) return;
  const std::string what =
      fmt::format("{}: the hand swung by {:.2g} mm where it was to hold still: ", touch.user, 1e3 * touch.swing);
  if (!has_network) return report.warnings.push_back(what + "its loop is not stable. Give a smaller stiffness");
  const char* remedy = !scene.compensation                ? "--compensation stiffness or simulation"
                       : !scene.compensation->is_softer() ? "--compensation stiffness, or max_damping = 50 in [touch]"
                                                          : "--compensation simulation, or max_damping = 50 in [touch]";
  report.warnings.push_back(what + "with this delay the loop is not stable. Give " + remedy);
}

void warn_of_undershoot(const sim::Scene& scene, const TouchReport& touch, bool has_network, Report& report) {
  if (!has_network || !scene.compensation || !scene.compensation->is_softer()) return;
  if (touch.largest_force >= kUnder * touch.largest_server_force - kUnderForce) return;
  report.warnings.push_back(fmt::format(
      "{}: at most {:.2g} N are rendered where the server's force is up to {:.2g} N: softer rendering shows what resists "
      "steadily, not the impact on what hardly does. Give --compensation simulation",
      touch.user, touch.largest_force, touch.largest_server_force));
}

/// An object at which several users are, whose clients simulate it without enough damping for long delays; empty: there is none.
std::string shared_object(const sim::Scene& scene) {
  if (!scene.compensation || scene.compensation->is_softer()) return {};
  if (scene.touch && scene.touch->max_damping >= kCalms) return {};
  for (std::size_t object = 0; object < scene.objects.size(); ++object) {
    const auto there = std::ranges::count(scene.users, object, &sim::SceneUser::object);
    if (there > 1 && scene.objects[object].dof != Dof::none) return scene.objects[object].name;
  }
  return {};
}

/// [s] there and back; its usual part.
double round_trip_of(const sim::NetworkOptions& network) {
  double sum = 0;
  for (const sim::LinkOptions* link : {&network.downlink, &network.uplink})
    sum += 1e-6 * (static_cast<double>(link->delay + link->gamma_mean) + 0.5 * static_cast<double>(link->jitter));
  return sum;
}

constexpr double kFarForTwo = 0.08;  // [s] of round trip at which two who squeeze a cube were first seen to swing

}  // namespace

void warn_of_two(const sim::NetworkOptions& network, const sim::Scene& scene) {
  const std::string object = shared_object(scene);
  if (object.empty() || round_trip_of(network) < kFarForTwo) return;
  fmt::print(
      stderr,
      "warning: {}: with --compensation simulation two users who push one object against each other may make it swing at a "
      "round trip of {:.0f} ms. Give --compensation stiffness, or max_damping = 50 in [touch]\n",
      object, 1e3 * round_trip_of(network));
}

void report_touches(const sim::Scene& scene, const sim::Simulation& simulation, bool has_network, Report& report) {
  if (report.ticks.count() == 0) return;
  std::vector<bool> looked(scene.deformables.size());
  for (std::size_t i = 0; i < scene.users.size(); ++i) {
    const sim::TouchSummary& t = simulation.touched(i);
    report.touches.push_back({.user = scene.users[i].name,
                              .contact_fraction = static_cast<double>(t.ticks) / static_cast<double>(report.ticks.count()),
                              .contacts = t.contacts,
                              .most_in_a_second = t.most_in_a_second,
                              .largest_force = t.largest_force,
                              .largest_server_force = t.largest_server_force,
                              .swing = t.swing,
                              .lowest_energy = t.lowest_energy});
    warn_of_chatter(report.touches.back(), report);
    warn_of_swing(scene, i, report.touches.back(), has_network, report);
    warn_of_undershoot(scene, report.touches.back(), has_network, report);
    warn_of_sampling(scene, simulation, i, report);
    if (!t.hardest || looked[t.hardest->mesh]) continue;
    looked[t.hardest->mesh] = true;
    warn_of_deformation(scene, *t.hardest, report);
  }
}

// ==== rigid report ====

namespace {

constexpr double kDeep = 0.1;    // of an object's smallest edge: penetration that is worth a warning
constexpr double kDrift = 1e-3;  // [m]

void warn_of_penetration(const sim::Scene& scene, const sim::RigidErrors& errors, Report& report) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Vec3& size = scene.objects[i].size;
    const double edge = std::min({size.x, size.y, size.z}), depth = errors.objects[i].penetration;
    if (depth <= kDeep * edge) continue;
    report.warnings.push_back(
        fmt::format("{}: it was {:.2g} mm deep in another object or the floor, and is {:.3g} mm thick. Make it "
                    "thicker, slower or lighter",
                    scene.objects[i].name, 1e3 * depth, 1e3 * edge));
  }
}

}  // namespace

void report_rigid(const sim::Scene& scene, const sim::RigidErrors& errors, Report& report) {
  if (std::ranges::none_of(scene.objects, [](const sim::SceneObject& object) { return object.dof != Dof::none; })) return;
  const auto name = [&scene](const sim::Worst& worst) { return scene.objects[worst.object].name; };
  const auto worst = [&name](const sim::Worst& of) {
    if (of.tick < 0) return RigidReport::Worst{};
    return RigidReport::Worst{of.value, sim::kTick * static_cast<double>(of.tick), name(of)};
  };
  report.rigid.emplace(RigidReport{.penetration = worst(errors.penetration),
                                   .drift = worst(errors.drift),
                                   .flight = worst(errors.flight),
                                   .residual = worst(errors.residual),
                                   .contact_energy = errors.contact_energy,
                                   .momentum = errors.momentum,
                                   .steps = errors.steps,
                                   .again = errors.solved_again,
                                   .unsolved = errors.unsolved});
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    report.rigid->objects.push_back(
        {scene.objects[i].name, errors.objects[i].penetration, errors.objects[i].drift, errors.objects[i].flight});
  if (errors.unsolved > 0)
    report.warnings.push_back(fmt::format(
        "{}: the contact solver left {:.2g} mm/s of approach at {:.3f} s, and {} unsolved in all. The contacts of what is "
        "stacked there are wrong: bring the masses nearer to each other, or stack less",
        name(errors.residual), 1e3 * errors.residual.value, sim::kTick * static_cast<double>(errors.residual.tick),
        counted(errors.unsolved, "step")));
  if (errors.unswept.tick >= 0)
    report.warnings.push_back(fmt::format("{}: at {:.3g} m/s it may pass thin objects unnoticed. Make it slower or larger",
                                          name(errors.unswept), errors.unswept.value));
  if (errors.drift.value > kDrift)
    report.warnings.push_back(
        fmt::format("{}: it crept {:.2g} mm while nobody pushed it. Stack less, or bring the masses nearer to "
                    "each other",
                    name(errors.drift), 1e3 * errors.drift.value));
  warn_of_penetration(scene, errors, report);
}

Outcome check_contacts(const Report& report, const std::string& scene) {
  if (!report.rigid || 20 * report.rigid->unsolved <= report.rigid->steps) return {};
  Failure failure{
      fmt::format("{}: contacts were not solved in {} of {} steps", scene, report.rigid->unsolved, report.rigid->steps),
      "The objects in the warnings may be anywhere: bring masses that touch nearer to each other, or stack less."};
  failure.cause = Failure::Cause::bound;
  failure.file = scene;
  return tl::unexpected(std::move(failure));
}

// ==== network judge ====

namespace {

constexpr std::size_t kKept = 4096;  // [ticks] of truth: more than any client lags behind

}  // namespace

NetworkJudge::NetworkJudge(const TraceInfo& info, const sim::Scene& scene, const TriggerArguments& triggers,
                           const MeshArguments& meshes)
    : compensates_(scene.compensation.has_value()), past_(kKept), info_(info) {
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

/// Of each object at a client; empty in a scene without interest, or while the client has no declaration.
std::span<const std::uint8_t> NetworkJudge::levels_at(Receiver* receiver, std::int64_t tick) {
  if (receiver == nullptr || !receiver->scene()->interest) return {};
  levels_.assign(info_.objects.size(), 0);
  for (const std::uint32_t object : receiver->scene()->moving()) levels_[object] = receiver->replica().lod(object, tick);
  return levels_;
}

void NetworkJudge::add(const sim::Simulation& simulation, sim::SessionNetwork& network) {
  const TraceFrame& now = simulation.frame();
  past_.add(now);
  for (std::size_t i = 0; i < users_.size(); ++i) {
    User& user = users_[i];
    NetworkReport& report = user.report;
    for (std::size_t m = 0; m < user.shapes.size(); ++m)
      if (now.meshes[m].updated) user.shapes[m].add(now.tick, now.meshes[m].displacements, touch_of(now, m));
    if (simulation.rendered_fraction(i) < 1) ++report.without_force;
    const sim::ClientCosts& costs = simulation.client_costs(i);
    const auto add = [](StepTimes& times, const sim::ClientCosts::Cost& cost) { times.add({cost.wall, cost.cpu}); };
    if (!user.shapes.empty()) add(report.shapes, costs.shapes);
    if (!info_.objects.empty()) add(report.poses, costs.poses);
    if (compensates_) add(report.compensation, costs.compensation);
    const TraceFrame* const truth = past_.at(simulation.shown_tick(i));
    if (truth == nullptr) {
      ++report.not_shown;
      continue;
    }
    for (PlayedShapes& shapes : user.shapes) shapes.look(network.client(i).receiver()->replica(), truth->tick);
    if (std::exchange(user.judged, truth->tick) < truth->tick)
      report.errors.add(*truth, simulation.received_poses(i), levels_at(network.client(i).receiver(), truth->tick));
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
                           .reordered = link.reordered};
  };
  std::vector<NetworkReport> out;
  for (std::size_t i = 0; i < users_.size(); ++i) {
    NetworkReport& report = out.emplace_back(std::move(users_[i].report));
    report.status = network.status(i);
    report.bound_scaling = network.bound_scaling(i);
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
