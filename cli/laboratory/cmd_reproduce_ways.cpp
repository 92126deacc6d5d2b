// SPDX-License-Identifier: Apache-2.0
/// Thesis figure 3.8 asks people which way of interpolation they prefer. In its place: what each way does to force and object. One run per
/// seed, whose hand feels the client without interpolation; clients of all ways are sent the same packets. A second run per seed, whose
/// hand feels an eased client (spec 60-client 8), has packets of its own.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tactus/metrics/errors.h>
#include <tactus/receiver.h>
#include <tactus/rigid/contact.h>
#include <tactus/sim/simulation.h>
#include "cli/laboratory/cmd_reproduce.h"
#include "cli/options/grip_option.h"
#include "cli/progress.h"
#include "cli/report/json_parts.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = std::numbers::pi / 180;
constexpr std::array kWays{Interpolation::none, Interpolation::linear, Interpolation::hermite, Interpolation::blending};
constexpr std::array kEased{Interpolation::none};  // in an eased scene
constexpr std::array kNames{"none", "linear", "hermite", "blending", "eased"};
constexpr std::array kScenes{"push-1dof", "rotate-6dof", "rotate-push-lift"};
constexpr std::array kDeadbands{0.04, 0.25};  // the second is the thesis's (3.2.3.2)

/// What a way does, of all seeds.
struct Effect {
  std::uint64_t ticks = 0, over = 0;  ///< in contact; out of the haptic rule
  double worst = 0;                   ///< error over what the rule permits
  std::vector<double> steps;          ///< change of the force error within the tick of an update, over the force
  std::vector<double> accelerations;  ///< [m/s^2] of the shown object between updates, in contact
  double quantile(const std::vector<double>& sorted, double share) const {
    return sorted.empty() ? 0 : sorted[static_cast<std::size_t>(std::lround(share * static_cast<double>(sorted.size() - 1)))];
  }
};
using Effects = std::array<Effect, kNames.size()>;

/// A client and what it showed last.
class Watcher {
 public:
  explicit Watcher(Receiver receiver) : receiver_(std::move(receiver)) {}

  static Result<Watcher> create(const SharedScene& scene, Interpolation way) {
    TACTUS_TRY(Receiver receiver, Receiver::create(scene, {.replica = {.interpolation = way}, .limits = {}}));
    return Watcher(std::move(receiver));
  }
  Result<void> take(std::span<const Packet> packets) {
    for (const Packet& packet : packets) TACTUS_CHECK(receiver_.push(packet.bytes));
    return {};
  }
  /// [N] at the pose shown now; the client keeps what it showed.
  Vec3 look(const TraceFrame& frame, const Contact& contact, bool updated, const RigidTriggers& triggers, Effect& effect) {
    const Pose shown = to_pose(receiver_.replica().pose(contact.object, frame.tick), receiver_.scene()->grid.position);
    const Vec3 force = contact_force(contact, frame.objects[contact.object].pose), estimate = contact_force(contact, shown);
    const double ratio = haptic_ratio(triggers, force, estimate);
    ++effect.ticks;
    effect.over += ratio > 1 ? 1 : 0;
    effect.worst = std::max(effect.worst, ratio);
    const Vec3 error = estimate - force;
    if (updated && error_ && norm(force) > triggers.force_floor) effect.steps.push_back(norm(error - *error_) / norm(force));
    error_ = error;
    since_update_ = updated ? 0 : since_update_ + 1;
    if (since_update_ >= 2 && known_ >= 2)
      effect.accelerations.push_back(norm(shown.position - 2 * before_ + before_that_) / (sim::kTick * sim::kTick));
    before_that_ = before_;
    before_ = shown.position;
    ++known_;
    return estimate;
  }
  void let_go() {
    error_.reset();
    known_ = 0;
  }

 private:
  Receiver receiver_;
  std::optional<Vec3> error_;
  Vec3 before_, before_that_;
  int since_update_ = 0, known_ = 0;
};

/// Force along the contact's normal: the truth, and that at what every way shows.
using Curves = std::vector<std::array<double, 2 + kWays.size()>>;

/// Packets per second.   in  ways, effects  as many;  curves  of kWays alone, or null
tl::expected<double, Failure> run_seed(const sim::Scene& scene, const sim::ChannelOptions& channel,
                                       const ReproduceOptions& options, std::uint64_t seed, std::span<const Interpolation> ways,
                                       std::span<Effect> effects, Curves* curves) {
  const RigidTriggers& triggers = channel.sender.triggers;
  auto simulation = sim::Simulation::create(scene, {.seed = seed, .grip = grip_of(options.grip), .channel = channel});
  if (!simulation) return refuse(scene.name, simulation.error());
  std::vector<Watcher> watchers;
  for (const Interpolation way : ways) {
    auto watcher = Watcher::create(simulation->stream_scene(), way);
    if (!watcher) return refuse(scene.name, watcher.error());
    watchers.push_back(*std::move(watcher));
  }
  std::uint64_t sent = 0;
  for (std::int64_t tick = 0; tick < simulation->ticks(); ++tick) {
    const auto packets = simulation->step();
    if (!packets) return refuse(scene.name, place_of_tick(tick), packets.error().error);
    sent += packets->size();
    const TraceFrame& frame = simulation->frame();
    const Contact& contact = frame.users[0].contact;
    Curves::value_type row{sim::kTick * static_cast<double>(tick)};
    if (contact.kind != ContactKind::none) row[1] = norm(contact_force(contact, frame.objects[contact.object].pose));
    for (std::size_t i = 0; i < watchers.size(); ++i) {
      if (const auto taken = watchers[i].take(*packets); !taken) return refuse(scene.name, place_of_tick(tick), taken.error());
      if (contact.kind == ContactKind::none) watchers[i].let_go();
      else row[2 + i] = norm(watchers[i].look(frame, contact, !packets->empty(), triggers, effects[i]));
    }
    if (curves != nullptr) curves->push_back(row);
  }
  return static_cast<double>(sent) / (sim::kTick * static_cast<double>(simulation->ticks()));
}

/// A scene at one deadband.
struct Case {
  const char* scene;
  double p;
  std::vector<double> rates, eased_rates;  ///< [packets/s] by seed
  Effects effects;
};

double mean(const std::vector<double>& of) { return std::accumulate(of.begin(), of.end(), 0.0) / static_cast<double>(of.size()); }

std::string percent(double share) { return fmt::format("{:.2f} %", 100 * share); }

void print(const std::vector<Case>& cases, const ReproduceOptions& options) {
  fmt::print(
      "Thesis figure 3.8, the part that needs no people: ways of interpolation, seeds 1 to {}. All but the last are sent the "
      "same packets,\n"
      "and the hand feels the client without interpolation. The last is that of profile main: the hand feels it.\n\n",
      options.seeds);
  Table table;
  table.heading({"scene", "p", "packets/s", "way", "out of the rule", "worst", "force step p50", "p99", "max",
                 "acceleration p90 [m/s2]", "p99"});
  for (const Case& c : cases) {
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      const Effect& e = c.effects[i];
      table.row({i == 0 ? c.scene : "", i == 0 ? fmt::format("{:.0f} %", 100 * c.p) : "",
                 i == 0              ? fmt::format("{:.1f}", mean(c.rates))
                 : i == kWays.size() ? fmt::format("{:.1f}", mean(c.eased_rates))
                                     : "",
                 kNames[i], percent(static_cast<double>(e.over) / static_cast<double>(std::max<std::uint64_t>(e.ticks, 1))),
                 fmt::format("{:.2f}", e.worst), percent(e.quantile(e.steps, 0.5)), percent(e.quantile(e.steps, 0.99)),
                 percent(e.quantile(e.steps, 1)), fmt::format("{:.2f}", e.quantile(e.accelerations, 0.9)),
                 fmt::format("{:.2f}", e.quantile(e.accelerations, 0.99))});
    }
  }
  table.print(stdout);
  fmt::print(
      "\nout of the rule  share of the ticks in contact in which the normal force at what is shown is off by more than the rule "
      "permits\n"
      "worst            largest error as a multiple of what is permitted\n"
      "force step       change of the normal force's error in the tick of an update, over the force (above the floor)\n"
      "acceleration     of the shown object in contact, between updates; a step of the grid in 1 ms is 0.24 m/s2\n");
}

void print_json(const std::vector<Case>& cases, const ReproduceOptions& options) {
  Json out{{"schema", "tactus.reproduce_ways/1"}, {"figure", "fig3.8"}, {"seeds", options.seeds}, {"grip", options.grip}};
  for (const Case& c : cases) {
    Json entry{{"scene", c.scene}, {"deadband", c.p}, {"packets_per_s", c.rates}, {"eased_packets_per_s", c.eased_rates}};
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      const Effect& e = c.effects[i];
      entry["ways"].push_back({{"way", kNames[i]},
                               {"ticks_in_contact", e.ticks},
                               {"ticks_over", e.over},
                               {"worst_ratio", e.worst},
                               {"force_step", {e.quantile(e.steps, 0.5), e.quantile(e.steps, 0.99), e.quantile(e.steps, 1)}},
                               {"acceleration_m_per_s2", {e.quantile(e.accelerations, 0.9), e.quantile(e.accelerations, 0.99)}}});
    }
    out["rows"].push_back(std::move(entry));
  }
  fmt::print("{}\n", text_of_json(out));
}

/// Seed 1 of the push at the thesis's deadband.
Plot figure_of(const Curves& curves) {
  Plot plot{.name = "fig3.8", .program = "interpolation-ways-3.8", .width = 900, .height = 420};
  PlotData data{"forces", {}};
  for (const auto& row : curves) data.rows.emplace_back(row.begin(), row.end());
  plot.data = {std::move(data)};
  return plot;
}

}  // namespace

Outcome reproduce_ways(const ReproduceOptions& options) {
  std::vector<Case> cases;
  Curves drawn;
  Progress progress("reproduce", kScenes.size() * kDeadbands.size() * options.seeds, options.common.progress());
  std::uint64_t done = 0;
  for (const char* name : kScenes) {
    const auto path = sim::find_scene(name);
    if (!path) return refuse(path.error());
    const auto scene = sim::load_scene(*path);
    if (!scene) return refuse(scene.error());
    for (const double p : kDeadbands) {
      RigidTriggers triggers;
      triggers.weber_fraction = p;
      triggers.visual_position = 0.01 * options.length_unit;  // thesis table 3.3, with interpolation
      triggers.visual_rotation = 4 * kDegree;
      Case& c = cases.emplace_back(Case{.scene = name, .p = p, .rates = {}, .eased_rates = {}, .effects = {}});
      for (std::uint64_t seed = 1; seed <= options.seeds; ++seed) {
        Curves curves;
        sim::ChannelOptions channel{.sender = {.triggers = triggers, .deformable = {}, .policy = {}},
                                    .replica = {},
                                    .coding = {.rigid = RigidProfile::thesis}};
        const std::span<Effect> effects(c.effects);
        TACTUS_TRY(const double rate, run_seed(*scene, channel, options, seed, kWays, effects.first(kWays.size()), &curves));
        c.rates.push_back(rate);
        channel.coding.rigid = RigidProfile::main;
        TACTUS_TRY(const double eased_rate,
                   run_seed(*scene, channel, options, seed, kEased, effects.last(kEased.size()), nullptr));
        c.eased_rates.push_back(eased_rate);
        if (name == kScenes.front() && p == kDeadbands.back() && seed == 1) drawn = std::move(curves);
        progress.update(++done);
      }
      for (Effect& e : c.effects) {
        std::ranges::sort(e.steps);
        std::ranges::sort(e.accelerations);
      }
    }
  }
  options.common.json ? print_json(cases, options) : print(cases, options);
  return write_figure(options, figure_of(drawn), {});
}

}  // namespace tactus::cli
