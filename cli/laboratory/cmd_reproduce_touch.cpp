// SPDX-License-Identifier: Apache-2.0
/// Figures of thesis chapter 4 that show what users of a scene feel behind a network. Hands are virtual and feel what is rendered, so that a
/// motion is not the same with delay and without, as with people.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tactus/sim/transparency/rigid_transparency.h>
#include "cli/laboratory/delay_figure.h"
#include "cli/progress.h"
#include "lab/study/delay.h"

namespace tactus::cli {
namespace {

namespace study = sim::study;

constexpr double kWeber = 0.1;                  // c
constexpr sim::SceneCompensation kStiffness{};  // with the thesis's adaptation

/// A figure that runs a scene.
struct TouchFigure {
  const char* figure;
  const char* title;
  const char* scene;
  sim::LinkOptions link;
  bool compensates = true;    ///< also with clients that make up for the delay
  bool is_soft_slab = false;  ///< thesis 4.18: k_o 100, b_o 2, m_o 0.1, in place of the scene's one-dimensional object
  double duration = 0;        ///< [s] 0: the scene's
};

/// There and back alike.
sim::LinkOptions constant(sim::Microseconds round_trip) { return {.delay = round_trip / 2}; }
const std::array<TouchFigure, 8>& figures() {
  static const std::array<TouchFigure, 8> all{{
      {"fig4.1", "two users push a block side by side, round trip 100 ms, without compensation", "jenga-together",
       constant(100'000), false},
      {"fig4.2", "a user presses a membrane and circles over it, round trip 100 ms, without compensation", "membrane",
       constant(100'000), false, false, 12},
      {"fig4.8", "the task of the subjects: a cube is pushed forth and back, round trip 100 ms", "push-cube", constant(100'000)},
      {"fig4.10", "two users push a block side by side, round trip 100 ms", "jenga-together", constant(100'000)},
      {"fig4.11", "one user pushes a block, another presses on it; varying round trip", "jenga-press", varying_network()},
      {"fig4.12", "one user pushes a block, another stops it; varying round trip", "jenga-against", varying_network()},
      {"fig4.25", "two users press a one-dimensional object, round trip 50 ms", "msd-1d", constant(50'000), true, true},
      {"fig4.27", "a user presses a membrane and circles over it, round trip 100 ms", "membrane", constant(100'000), true, false,
       12},
  }};
  return all;
}

tl::expected<sim::Scene, Failure> scene_of(const TouchFigure& figure) {
  const auto path = sim::find_scene(figure.scene);
  if (!path) return refuse(path.error());
  auto scene = sim::load_scene(*path);
  if (!scene) return refuse(scene.error());
  if (figure.duration > 0) scene->duration = std::min(scene->duration, figure.duration);
  if (figure.is_soft_slab) {
    scene->msds[0].object = {100, 2, 0.1};
    scene->msds[0].rate = 1;
    scene->msds[0].touch_damping = 0;  // 4.3.4.1: none for hands
  }
  return *scene;
}

/// The runs of one seed.
struct Runs {
  study::DelayRun reference, without;
  std::optional<study::DelayRun> with;
};

tl::expected<Runs, Failure> run_all(const TouchFigure& figure, const sim::Scene& scene, std::uint64_t seed) {
  const auto run = [&](bool is_local,
                       std::optional<sim::SceneCompensation> compensation) -> tl::expected<study::DelayRun, Failure> {
    sim::LinkOptions link = figure.link;
    link.seed = seed;
    auto out = study::run_delayed(scene, {.link = link, .compensation = compensation, .is_local = is_local, .seed = seed});
    if (!out) return refuse(figure.scene, out.error().error);
    return *std::move(out);
  };
  Runs out;
  TACTUS_TRY(out.reference, run(true, {}));
  TACTUS_TRY(out.without, run(false, {}));
  if (!figure.compensates) return out;
  TACTUS_TRY(out.with, run(false, kStiffness));
  return out;
}

/// A number of a user's force, of every seed.
struct Spread {
  std::vector<double> values;
  double mean() const {
    double sum = 0;
    for (const double v : values) sum += v;
    return values.empty() ? 0 : sum / static_cast<double>(values.size());
  }
  double farthest() const {
    return values.empty() ? 0 : *std::ranges::max_element(values, {}, [](double v) { return std::abs(v); });
  }
};

struct UserEffects {
  Spread mean, peak, outside, energy;

  void add(const std::vector<study::DelayTick>& delayed, const std::vector<study::DelayTick>& reference) {
    const study::DelayEffect e = study::effect_of(delayed, reference, kWeber);
    energy.values.push_back(1e3 * e.lowest_energy);
    if (e.reference_mean == 0) return;  // in this seed the hand misses the object
    mean.values.push_back(100 * (e.mean / e.reference_mean - 1));
    peak.values.push_back(100 * (e.peak / e.reference_peak - 1));
    outside.values.push_back(100 * e.outside);
  }
};

void tell(DelayFigure& out, const std::string& user, const UserEffects& without, const std::optional<UserEffects>& with) {
  const auto row = [&](const char* what, const char* unit, Spread UserEffects::*of) {
    FigureNumber q{user + ": " + what, unit, {(without.*of).mean(), (without.*of).farthest()}};
    if (with) q.values.insert(q.values.end(), {(*with.*of).mean(), (*with.*of).farthest()});
    out.quantities.push_back(std::move(q));
  };
  row("mean force over that without delay", "%", &UserEffects::mean);
  row("peak of the force over that without delay", "%", &UserEffects::peak);
  row("time outside +-10 % of the force without delay", "%", &UserEffects::outside);
  row("least energy that the device has put in", "mJ", &UserEffects::energy);
}

/// Time, then for each user the force without delay, delayed, with compensation, its stiffness, and the round trip.
void draw_runs(DelayFigure& out, const sim::Scene& scene, const Runs& runs) {
  out.plot = {.name = out.figure, .program = "delay-touch", .width = 960, .height = scene.users.size() > 1 ? 640 : 380};
  std::vector<std::string> names;
  out.table = "time_s";
  for (const sim::SceneUser& user : scene.users) {
    names.push_back(user.name);
    out.table +=
        fmt::format(",{0}_without_delay_N,{0}_delayed_N,{0}_compensated_N,{0}_stiffness_N_per_m,{0}_round_trip_ms", user.name);
  }
  out.table += "\n";
  out.plot.set("users", names);
  out.plot.set("compensated", runs.with ? 1.0 : 0.0);
  out.plot.set("duration", sim::kTick * static_cast<double>(runs.reference.paths.size()));
  PlotData data{"touch", {}};
  constexpr std::size_t kDrawn = 4;  // every so many ticks, which no eye tells from all
  for (std::size_t tick = 0; tick < runs.reference.paths.size(); ++tick) {
    std::vector<double> row{sim::kTick * static_cast<double>(tick)};
    for (std::size_t i = 0; i < scene.users.size(); ++i) {
      const study::DelayTick& delayed = runs.without.users[i][tick];
      const study::DelayTick with = runs.with ? runs.with->users[i][tick] : study::DelayTick{};
      row.insert(row.end(),
                 {runs.reference.users[i][tick].client, delayed.client, with.client, with.stiffness, 1e3 * delayed.round_trip});
    }
    out.table += fmt::format("{:.6g}\n", fmt::join(row, ","));
    if (tick % kDrawn == 0) data.rows.push_back(std::move(row));
  }
  out.plot.data = {std::move(data)};
}

tl::expected<DelayFigure, Failure> make(const TouchFigure& figure, const ReproduceOptions& options) {
  TACTUS_TRY(const sim::Scene scene, scene_of(figure));
  DelayFigure out{.figure = figure.figure, .title = figure.title};
  out.columns = {"without", "worst seed"};
  if (figure.compensates) out.columns.insert(out.columns.end(), {"with", "worst seed with"});
  std::vector<UserEffects> without(scene.users.size()), with(scene.users.size());
  Spread round_trips, lowest;
  Progress progress("reproduce", options.seeds, options.common.progress());
  for (std::uint32_t seed = 1; seed <= options.seeds; ++seed) {
    TACTUS_TRY(const Runs runs, run_all(figure, scene, seed));
    for (std::size_t i = 0; i < scene.users.size(); ++i) {
      without[i].add(runs.without.users[i], runs.reference.users[i]);
      if (runs.with) with[i].add(runs.with->users[i], runs.reference.users[i]);
      for (std::size_t tick = 1000; tick < runs.without.users[i].size(); tick += 100)
        round_trips.values.push_back(1e3 * runs.without.users[i][tick].round_trip);
    }
    if (seed == 1) draw_runs(out, scene, runs);
    progress.update(seed);
  }
  for (std::size_t i = 0; i < scene.users.size(); ++i)
    tell(out, scene.users[i].name, without[i], figure.compensates ? std::optional(with[i]) : std::nullopt);
  out.quantities.push_back({"round trip as the client sees it", "ms", {round_trips.mean(), round_trips.farthest()}});
  return out;
}

/// Devices of two users who push the block side by side at constant speed, in place of their hands.
study::DevicePaths constant_speed(const sim::Scene& scene, double speed, double duration) {
  study::DevicePaths paths;
  const double face = scene.objects[0].pose.position.x - scene.objects[0].size.x / 2;
  const auto ticks = static_cast<std::size_t>(std::llround(duration / sim::kTick));
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    const double t = sim::kTick * static_cast<double>(tick);
    std::vector<DeviceSample>& devices = paths.emplace_back();
    for (const sim::SceneUser& user : scene.users)
      devices.push_back({.position = {face - 0.001 + speed * t, user.start.y, user.start.z}});
  }
  return paths;
}

/// [N] mean of the last second.
double steady(const std::vector<study::DelayTick>& ticks) {
  double sum = 0;
  for (std::size_t i = ticks.size() - 1000; i < ticks.size(); ++i) sum += ticks[i].client;
  return sum / 1000;
}

constexpr sim::Microseconds kJump = 2'800'000;  // of the delay, in the thesis's figure

/// There and back alike, longer by so much from kJump on.
sim::LinkOptions jumping(sim::Microseconds round_trip, sim::Microseconds by) {
  sim::LinkOptions out = constant(round_trip);
  out.recorded = {{0, 0}, {kJump, by / 2}, {3'600'000'000, 0}};
  return out;
}

/// After a jump of the delay: how far the force is off at most [%], and for how long more than c [ms].
std::array<double, 2> after_jump(const study::DelayRun& run, const study::DelayRun& reference) {
  double most = 0, ticks = 0;
  for (std::size_t i = kJump / 1000; i < run.users[0].size(); ++i) {
    const double off = run.users[0][i].client / reference.users[0][i].client - 1;
    if (std::abs(off) > std::abs(most)) most = off;
    ticks += std::abs(off) > kWeber ? 1 : 0;
  }
  return {100 * most, ticks};
}

/// What jumps of the delay do to the push, by more than 4.32 bears.
tl::expected<void, Failure> add_jumps(DelayFigure& out, sim::Scene scene, double speed) {
  scene.duration = 20;  // [s] what a session takes for its delay is the least of 10 s: a longer one acts after so long
  const study::DevicePaths paths = constant_speed(scene, speed, scene.duration);
  const auto reference = study::run_delayed(scene, {.is_local = true, .paths = &paths});
  if (!reference) return refuse(scene.name, reference.error().error);
  for (const sim::Microseconds by : {20'000, 50'000, 100'000}) {
    const auto run = [&](std::optional<sim::SceneCompensation> compensation) {
      return study::run_delayed(scene, {.link = jumping(50'000, by), .compensation = compensation, .paths = &paths});
    };
    const auto without = run({}), with = run(kStiffness);
    if (!without || !with) return refuse(scene.name, (without ? with : without).error().error);
    const auto [most_without, long_without] = after_jump(*without, *reference);
    const auto [most_with, long_with] = after_jump(*with, *reference);
    const std::string name = fmt::format("50 ms, then {} ms: ", (50'000 + by) / 1000);
    out.quantities.push_back({name + "farthest from the force without delay", "%", {most_without, most_with, {}}});
    out.quantities.push_back({name + "time more than 10 % from it", "ms", {long_without, long_with, {}}});
  }
  return {};
}

/// Forces at constant speed: the steady state, which the models describe.
tl::expected<DelayFigure, Failure> constant_push() {
  constexpr double kBound = 0.018, kDuration = 5;                     // [s] that the thesis's figure bears; of the run
  constexpr std::array kRoundTrips{18'000, 25'000, 50'000, 100'000};  // [us]
  const TouchFigure of{"fig4.6", "", "jenga-together", {}, true, false, kDuration};
  TACTUS_TRY(const sim::Scene scene, scene_of(of));
  const sim::SceneObject& block = scene.objects[0];
  const double friction = block.friction * block.mass * norm(scene.gravity) / 2, stiffness = scene.touch->stiffness;
  const double damping = sim::damping_of_factor(block.mass, block.damping, sim::kTick) / 2;
  const double speed = kWeber * friction / (stiffness * kBound - kWeber * damping);  // 4.31
  const study::DevicePaths paths = constant_speed(scene, speed, kDuration);
  const auto run = [&](sim::Microseconds round_trip, std::optional<sim::SceneCompensation> compensation) {
    return study::run_delayed(scene, {.link = constant(round_trip), .compensation = compensation, .paths = &paths});
  };
  DelayFigure out{.figure = "fig4.6",
                  .title = fmt::format("two users push a block side by side at constant {:.2f} mm/s", 1e3 * speed)};
  out.columns = {"without", "with", "thesis without"};
  const auto reference = study::run_delayed(scene, {.is_local = true, .paths = &paths});
  if (!reference) return refuse(of.scene, reference.error().error);
  out.plot = {.name = "fig4.6", .program = "delay-constant-push", .width = 960, .height = 380};
  std::vector<study::DelayRun> runs{*reference};
  for (const sim::Microseconds round_trip : kRoundTrips) {
    const auto without = run(round_trip, {}), with = run(round_trip, kStiffness);
    if (!without || !with) return refuse(of.scene, (without ? with : without).error().error);
    const auto over = [&](const study::DelayRun& r) { return 100 * (steady(r.users[0]) / steady(reference->users[0]) - 1); };
    out.quantities.push_back({fmt::format("{} ms: steady force over that without delay", round_trip / 1000),
                              "%",
                              {over(*without), over(*with), round_trip == 18'000 ? std::optional(10.0) : std::nullopt}});
    runs.insert(runs.end(), {*without, *with});
  }
  TACTUS_CHECK(add_jumps(out, scene, speed));
  std::vector<double> delays;
  delays.reserve(kRoundTrips.size());
  for (const sim::Microseconds r : kRoundTrips) delays.push_back(1e-3 * static_cast<double>(r));
  out.plot.set("delays", delays);
  out.table = "time_s,0ms_N,18ms_N,18ms_with_N,25ms_N,25ms_with_N,50ms_N,50ms_with_N,100ms_N,100ms_with_N\n";
  PlotData data{"forces", {}};
  for (std::size_t tick = 0; tick < paths.size(); ++tick) {
    std::vector<double> row{sim::kTick * static_cast<double>(tick)};
    for (const study::DelayRun& r : runs) row.push_back(r.users[0][tick].client);
    out.table += fmt::format("{:.6g}\n", fmt::join(row, ","));
    if (tick % 4 == 0) data.rows.push_back(std::move(row));
  }
  out.plot.data = {std::move(data)};
  return out;
}

}  // namespace

bool is_touch_figure(const std::string& figure) {
  return figure == "fig4.6" || std::ranges::any_of(figures(), [&](const TouchFigure& f) { return figure == f.figure; });
}

Outcome reproduce_touch(const ReproduceOptions& options) {
  if (options.figure == "fig4.6") {
    TACTUS_TRY(const DelayFigure made, constant_push());
    return finish(options, made);
  }
  const auto found = std::ranges::find_if(figures(), [&](const TouchFigure& f) { return options.figure == f.figure; });
  TACTUS_TRY(const DelayFigure made, make(*found, options));
  return finish(options, made);
}

}  // namespace tactus::cli
