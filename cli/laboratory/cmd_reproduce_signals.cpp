// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <system_error>
#include <vector>

#include <tactus/sim/simulation.h>
#include "cli/figure/plot.h"
#include "cli/laboratory/cmd_reproduce.h"
#include "cli/options/grip_option.h"
#include "cli/output.h"
#include "cli/report/figures.h"
#include "cli/report/json_parts.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = std::numbers::pi / 180;

/// One tick of a push along x.
struct Tick {
  double time = 0;                 ///< [s]
  double felt = 0, server = 0;     ///< [N] along x, on the hand
  double position = 0, shown = 0;  ///< [m] of the object
  int reason = -1;                 ///< of the packet of this tick; -1: there was none
};

tl::expected<std::vector<Tick>, Failure> push(double p, Interpolation interpolation, const ReproduceOptions& options) {
  const auto path = sim::find_scene("push-1dof");
  if (!path) return refuse(path.error());
  const auto scene = sim::load_scene(*path);
  if (!scene) return refuse(scene.error());
  sim::ChannelOptions channel;
  channel.coding.rigid = RigidProfile::thesis;
  channel.sender.triggers.weber_fraction = p;
  channel.sender.triggers.visual_position = 0.01 * options.length_unit;  // thesis 3.2.4.1
  channel.sender.triggers.visual_rotation = 4 * kDegree;
  channel.replica.interpolation = interpolation;
  auto simulation = sim::Simulation::create(*scene, {.seed = 1, .grip = grip_of(options.grip), .channel = channel});
  if (!simulation) return refuse(scene->name, simulation.error());
  constexpr std::int64_t kStandsStill = 1500;  // [ticks] more, for the heartbeat
  std::vector<Tick> out;
  for (std::int64_t tick = 0; tick < simulation->ticks() + kStandsStill; ++tick) {
    const auto packets = simulation->step();
    if (!packets) return refuse(scene->name, place_of_tick(tick), packets.error().error);
    const TraceFrame& frame = simulation->frame();
    Tick& now = out.emplace_back();
    now.time = 1e-3 * static_cast<double>(tick);
    now.felt = frame.users[0].force.x;
    now.server = frame.users[0].server_force.x;
    now.position = frame.objects[0].pose.position.x;
    now.shown = simulation->client_poses()[0].position.x;
    if (!packets->empty()) now.reason = static_cast<int>(packets->front().reason);
  }
  return out;
}

std::string csv_of(const std::vector<Tick>& ticks) {
  std::string out = "time_s,force_felt_N,force_server_N,position_m,position_shown_m,update\n";
  for (const Tick& t : ticks)
    out += fmt::format("{:.3f},{:.6g},{:.6g},{:.8g},{:.8g},{}\n", t.time, t.felt, t.server, t.position, t.shown,
                       t.reason < 0 ? "" : kReasons[static_cast<std::size_t>(t.reason)]);
  return out;
}

PlotData curve(const char* name, const std::vector<Tick>& ticks, double Tick::*value, double scale) {
  PlotData out{name, {}};
  for (const Tick& t : ticks) out.rows.push_back({t.time, scale * t.*value});
  return out;
}
PlotData updates(const char* name, const std::vector<Tick>& ticks, int reason) {
  PlotData out{name, {}};
  for (const Tick& t : ticks)
    if (t.reason == reason) out.rows.push_back({t.time, 1e3 * t.position});
  if (out.rows.empty()) out.rows.push_back({-1, 0});  // outside of the figure
  return out;
}

/// Changes of the felt force from tick to tick, [N]: the largest, and the median where an update came.
struct Jumps {
  double largest = 0, median = 0;
};
Jumps jumps_of(const std::vector<Tick>& ticks) {
  Jumps out;
  std::vector<double> at_updates;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    const double jump = std::abs(ticks[i].felt - ticks[i - 1].felt);
    out.largest = std::max(out.largest, jump);
    if (ticks[i].reason >= 0) at_updates.push_back(jump);
  }
  if (at_updates.empty()) return out;
  const auto middle = at_updates.begin() + static_cast<std::ptrdiff_t>(at_updates.size() / 2);
  std::ranges::nth_element(at_updates, middle);
  out.median = *middle;
  return out;
}

}  // namespace

Outcome make_folder(const std::string& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) return refuse(directory + ": the folder cannot be made: " + error.message(), "Check the path and your permissions.");
  return {};
}

Outcome write_figure(const ReproduceOptions& options, const Plot& plot,
                     const std::vector<std::pair<std::string, std::string>>& tables) {
  if (options.directory.empty()) return {};
  TACTUS_CHECK(make_folder(options.directory));
  for (const auto& [name, text] : tables)
    TACTUS_CHECK(write_file(options.directory + "/" + name, text, options.common.existing()));
  TACTUS_TRY(const auto drawn, draw(plot, options.directory, options.common.existing()));
  if (drawn == Drawn::no) fmt::print(stderr, "note: {}\n", kNoGnuplot);
  return {};
}

Outcome reproduce_traffic(const ReproduceOptions& options) {
  TACTUS_TRY(const std::vector<Tick> ticks, push(0.08, Interpolation::none, options));
  std::array<std::array<std::size_t, 4>, 2> counts{};  // in contact or not, by reason
  std::array<double, 2> seconds{};
  double still = 0;
  constexpr std::array kPhases{"pushed", "not touched"};
  for (const Tick& t : ticks) {
    const std::size_t touched = t.server != 0 ? 0 : 1;
    seconds[touched] += 1e-3;
    if (t.reason >= 0) ++counts[touched][static_cast<std::size_t>(t.reason)];
    if (t.reason == static_cast<int>(Reason::heartbeat) && still == 0) still = t.time;
  }
  if (options.common.json) {
    Json out{{"schema", "tactus.reproduce_signals/1"}, {"figure", "fig3.3"}, {"first_heartbeat_s", still}};
    for (std::size_t i = 0; i < 2; ++i)
      out["rows"].push_back({{"name", kPhases[i]},
                             {"seconds", seconds[i]},
                             {"haptic", counts[i][3]},
                             {"visual", counts[i][2]},
                             {"heartbeat", counts[i][1]}});
    fmt::print("{}\n", text_of_json(out));
  } else {
    fmt::print("Thesis figure 3.3: why updates are sent while a cube is pushed, push-1dof, p = 8 %, seed 1\n\n");
    Table table;
    table.heading({"", "time [s]", "haptic", "visual", "heartbeat", "updates/s"});
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& c = counts[i];
      table.row({kPhases[i], fmt::format("{:.2f}", seconds[i]), fmt::to_string(c[3]), fmt::to_string(c[2]), fmt::to_string(c[1]),
                 fmt::format("{:.1f}", static_cast<double>(c[0] + c[1] + c[2] + c[3]) / seconds[i])});
    }
    table.print(stdout);
    fmt::print("\nThe first heartbeat comes at {:.2f} s, a second after the last update.\n", still);
  }
  Plot plot{.name = "fig3.3", .program = "traffic-figure-3.3", .width = 900, .height = 620};
  plot.data = {curve("force", ticks, &Tick::felt, 1), curve("position", ticks, &Tick::position, 1e3), updates("haptic", ticks, 3),
               updates("visual", ticks, 2), updates("heartbeat", ticks, 1)};
  return write_figure(options, plot, {{"fig3.3.csv", csv_of(ticks)}});
}

Outcome reproduce_interpolation(const ReproduceOptions& options) {
  TACTUS_TRY(const std::vector<Tick> without, push(0.074, Interpolation::none, options));
  TACTUS_TRY(const std::vector<Tick> with, push(0.187, Interpolation::linear, options));
  struct Row {
    const char *name, *p;
    const std::vector<Tick>& ticks;
  };
  const std::array rows{Row{"without", "7.4 %", without}, Row{"with", "18.7 %", with}};
  Json out{{"schema", "tactus.reproduce_signals/1"}, {"figure", "fig3.11"}};
  Table table;
  table.heading({"interpolation", "p", "updates", "jump of the force at an update, median [N]", "largest within 1 ms [N]"});
  for (const Row& row : rows) {
    const auto count = std::ranges::count_if(row.ticks, [](const Tick& t) { return t.reason >= 0; });
    const Jumps jumps = jumps_of(row.ticks);
    out["rows"].push_back(
        {{"name", row.name}, {"updates", count}, {"median_jump_N", jumps.median}, {"largest_jump_N", jumps.largest}});
    table.row(
        {row.name, row.p, fmt::to_string(count), fmt::format("{:.3f}", jumps.median), fmt::format("{:.3f}", jumps.largest)});
  }
  if (options.common.json) {
    fmt::print("{}\n", text_of_json(out));
  } else {
    fmt::print("Thesis figure 3.11: the rendered force with and without interpolation, push-1dof, seed 1\n\n");
    table.print(stdout);
  }
  Plot plot{.name = "fig3.11", .program = "interpolation-figure-3.11", .width = 900, .height = 620};
  plot.data = {curve("felt_without", without, &Tick::felt, 1), curve("server_without", without, &Tick::server, 1),
               curve("felt_with", with, &Tick::felt, 1), curve("server_with", with, &Tick::server, 1)};
  return write_figure(options, plot, {{"fig3.11-without.csv", csv_of(without)}, {"fig3.11-with.csv", csv_of(with)}});
}

}  // namespace tactus::cli
