// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include <tactus/base/shown.h>
#include <tactus/metrics/delay_tolerance.h>
#include <tactus/trace/trace_file.h>
#ifdef TACTUS_HAS_SIM
#include "cli/commands/scene_run.h"
#endif
#include "cli/commands/input.h"
#include "cli/figure/figure.h"
#include "cli/options/options_codec.h"
#include "cli/options/units.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/report/json.h"
#include "cli/report/messages.h"

namespace tactus::cli {
namespace {

using Pair = DelayTolerance::Pair;
struct TolerableOptions {
  std::string input, plot;
  std::uint64_t seed = 1;
  double weber = 0.1;
  CommonOptions common;
};

const std::string& object_name(const TraceInfo& info, const Pair& pair) {
  return pair.is_mesh ? info.meshes[pair.object].name : info.objects[pair.object].name;
}

double seconds(const TraceInfo& info, std::uint64_t ticks) { return static_cast<double>(ticks) / info.tick_rate; }

Value tolerable_value(const TolerableOptions& options, const TraceInfo& info, const DelayTolerance& tolerance, bool is_scene) {
  Json out{
      {"schema", "tactus.tolerable/1"}, {"trace", options.input}, {"weber_fraction", options.weber}, {"touches", Json::array()}};
  for (const auto& [pair, touch] : tolerance.touches()) {
    Json entry{{"user", info.users[pair.user].name},
               {pair.is_mesh ? "mesh" : "object", object_name(info, pair)},
               {"seconds", seconds(info, touch.ticks())},
               {"pressing_seconds", seconds(info, touch.pressing())},
               {"follows", touch.follows()}};
    const auto limit = [&entry, &touch = touch](const char* key, double fraction) {
      if (const auto most = touch.quantile(fraction)) entry[key] = *most;
    };
    limit("tolerable_p5_s", 0.05);
    limit("tolerable_p50_s", 0.5);
    for (std::size_t i = 0; i < DelayTolerance::kRoundTrips.size(); ++i)
      entry["perceptible"].push_back({{"round_trip_s", DelayTolerance::kRoundTrips[i]}, {"fraction", touch.perceptible(i)}});
    out["touches"].push_back(std::move(entry));
  }
  if (!is_scene && !info.meshes.empty())
    out["notes"] = {"A deformable object gives way and tolerates more than that; give its scene to see how much."};
  return out;
}

/// Over the round trip, in how much of the time in contact it is perceptible: a line for each touch.
Figure fraction_figure(const TolerableOptions& options, const TraceInfo& info, const DelayTolerance& tolerance) {
  constexpr int kSteps = 100;
  Panel panel{"fraction of the time in contact [%]"};
  for (const auto& [pair, touch] : tolerance.touches()) {
    Panel::Line& line =
        panel.lines.emplace_back(Panel::Line{fmt::format("{}, {}", info.users[pair.user].name, object_name(info, pair)), {}});
    const double pressing =
        100.0 * static_cast<double>(touch.pressing()) / static_cast<double>(std::max<std::uint64_t>(touch.ticks(), 1));
    for (int step = 1; step < kSteps; ++step) {
      const auto most = touch.quantile(static_cast<double>(step) / kSteps);
      if (!most) break;
      line.points.push_back({1e3 * *most, pressing * step / kSteps});
    }
  }
  return {.heading = fmt::format("{}: round trips perceived as {:g} % more force", options.input, 100 * options.weber),
          .panels = {std::move(panel)},
          .x_label = "round trip [ms]",
          .logarithmic_x = true};
}

tl::expected<DelayTolerance, Failure> of_trace(const TolerableOptions& options, TraceReader& reader) {
  DelayTolerance out(reader.info(), options.weber);
  ReadProgress progress("tolerable", &reader, options.common.progress());
  TraceFrame frame;
  std::uint64_t read = 0;
  for (;; ++read) {
    TACTUS_TRY(const bool more, next_frame(reader, frame, options.input));
    if (!more) break;
    out.add(frame);
    progress.update(read + 1);
  }
  TACTUS_CHECK(check_ending(options.input, reader, read));
  return out;
}

Outcome report(const TolerableOptions& options, const TraceInfo& info, const DelayTolerance& tolerance, bool is_scene) {
  if (tolerance.touches().empty())
    return refuse(shown_path(options.input) + ": nobody touches anything", "Give a recording or a scene with contacts.");
  TACTUS_CHECK(draw(options.plot, fraction_figure(options, info, tolerance), options.common));
  print(tolerable_value(options, info, tolerance, is_scene), "tolerable", options.common);
  return {};
}

#ifdef TACTUS_HAS_SIM
Outcome run_scene(const TolerableOptions& options) {
  TACTUS_TRY(TolerableScene scene, TolerableScene::create(options.input, options.seed));
  const TraceInfo info = scene.info();
  DelayTolerance tolerance(info, options.weber);
  Progress progress("tolerable", static_cast<std::uint64_t>(scene.ticks()), options.common.progress());
  for (std::int64_t tick = 0; tick < scene.ticks(); ++tick) {
    TACTUS_TRY(const TraceFrame* frame, scene.next());
    tolerance.add(*frame, [&](const Pair& pair, const UserSample& user) { return scene.follows(pair, user); });
    progress.update(static_cast<std::uint64_t>(tick) + 1);
  }
  return report(options, info, tolerance, true);
}
#endif

Outcome run_tolerable(const TolerableOptions& options) {
  TACTUS_CHECK(check_plot_option(options.plot, options.common, {options.input}));
#ifdef TACTUS_HAS_SIM
  if (TolerableScene::is_meant(options.input)) return run_scene(options);
#endif
  auto reader = open_trace(options.input, options.common.progress());
  if (!reader) return tl::unexpected(reader.error());
  if (reader->info().users.empty())
    return refuse(shown_path(options.input) + ": nobody is in this recording", "Give one with a user, as `tactus sim` makes.");
  TACTUS_TRY(const DelayTolerance tolerance, of_trace(options, *reader));
  return report(options, reader->info(), tolerance, false);
}

}  // namespace

void setup_tolerable(Command& app, Action& action) {
  auto options = std::make_shared<TolerableOptions>();
  Command& command =
      app.add_command("tolerable", "Compute how much delay the touches of a recording or a scene tolerate unnoticed");
  command
      .add_option("TRACE", options->input, "Recording with contacts (MCAP), - is standard input; or a scene, which is simulated")
      ->type_name("")
      ->required();
  add_quantity(command, "-c,--weber-fraction", options->weber, Dimension::fraction,
               "Change of the force that is just noticeable [10%]")
      ->check(above_zero(Dimension::fraction));
#ifdef TACTUS_HAS_SIM
  command.add_option("--seed", options->seed, "Of the hands of a scene")
      ->check(whole_number(0, UINT64_MAX))
      ->show_default()
      ->type_name("N");
#endif
  add_plot_option(command, options->plot, "the fraction of the time in contact in which a round trip is perceptible");
  add_output_options(command, options->common);
  command.footer(
      "A client learns of an object's motion a round trip late. Meanwhile a hand that presses goes further into what the client\n"
      "shows, and feels more than at the server (thesis eqs. 4.17 to 4.20, 4.31). What is deformable follows only a fraction of "
      "the\n"
      "device's displacement, and tolerates as much more; a recording does not tell which fraction (eq. 4.54).\n"
      "Examples:\n  tactus sim push-1dof -o push.mcap && tactus tolerable push.mcap\n  tactus tolerable membrane");
  on_chosen<TolerableOptions>(command, action, options, run_tolerable);
}

}  // namespace tactus::cli
