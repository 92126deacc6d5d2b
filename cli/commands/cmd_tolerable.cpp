// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include <tactus/base/shown.h>
#include <tactus/metrics/delay_tolerance.h>
#include <tactus/trace/trace_file.h>
#include "cli/options/options_codec.h"
#include "cli/options/units.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/report/json_parts.h"
#include "cli/report/messages.h"
#include "cli/report/table.h"
#include "cli/report/trace_ending.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;
using Pair = DelayTolerance::Pair;
using Touch = DelayTolerance::Touch;

struct TolerableOptions {
  std::string input;
  double weber = 0.1;
  CommonOptions common;
};

const std::string& name_of(const TraceInfo& info, const Pair& pair) {
  return pair.is_mesh ? info.meshes[pair.object].name : info.objects[pair.object].name;
}

double seconds(const TraceInfo& info, std::uint64_t ticks) { return static_cast<double>(ticks) / info.tick_rate; }

Json to_json(const TolerableOptions& options, const TraceInfo& info, const DelayTolerance& tolerance) {
  Json out{
      {"schema", "tactus.tolerable/1"}, {"trace", options.input}, {"weber_fraction", options.weber}, {"touches", Json::array()}};
  for (const auto& [pair, touch] : tolerance.touches()) {
    Json entry{{"user", info.users[pair.user].name},
               {pair.is_mesh ? "mesh" : "object", name_of(info, pair)},
               {"seconds", seconds(info, touch.ticks())},
               {"pressing_seconds", seconds(info, touch.pressing())}};
    const auto limit = [&entry, &touch = touch](const char* key, double share) {
      if (const auto most = touch.quantile(share)) entry[key] = *most;
    };
    limit("tolerable_p5_s", 0.05);
    limit("tolerable_p50_s", 0.5);
    for (std::size_t i = 0; i < DelayTolerance::kRoundTrips.size(); ++i)
      entry["felt"].push_back({{"round_trip_s", DelayTolerance::kRoundTrips[i]}, {"share", touch.felt(i)}});
    out["touches"].push_back(std::move(entry));
  }
  return out;
}

std::string milliseconds(const Touch& touch, double share) {
  const auto most = touch.quantile(share);
  if (most) return fmt::format("{:.1f}", 1e3 * *most);
  return touch.pressing() == 0 ? "-" : fmt::format("> {:.0f}", 1e3 * Touch::kLongest);
}

void print_text(const TolerableOptions& options, const TraceInfo& info, const DelayTolerance& tolerance) {
  fmt::print(
      "Round trips that the touches of {} bear until {:g} % more force is felt, and the share of the time in contact in which\n"
      "a round trip is felt\n\n",
      shown_path(options.input), 100 * options.weber);
  Table table;
  std::vector<std::string> heading{"user, object", "contact [s]", "pressing [s]", "bears, 5 % [ms]", "median [ms]"};
  for (const double round_trip : DelayTolerance::kRoundTrips) heading.push_back(fmt::format("{:g} ms", 1e3 * round_trip));
  table.heading(std::move(heading));
  for (const auto& [pair, touch] : tolerance.touches()) {
    std::vector<std::string> row{fmt::format("{}, {}", shown(info.users[pair.user].name), shown(name_of(info, pair))),
                                 fmt::format("{:.2f}", seconds(info, touch.ticks())),
                                 fmt::format("{:.2f}", seconds(info, touch.pressing())), milliseconds(touch, 0.05),
                                 milliseconds(touch, 0.5)};
    for (std::size_t i = 0; i < DelayTolerance::kRoundTrips.size(); ++i)
      row.push_back(fmt::format("{:.1f} %", 100 * touch.felt(i)));
    table.row(std::move(row));
  }
  table.print(stdout);
  if (!info.meshes.empty()) fmt::print("\nA deformable object gives way and bears more than that.\n");
}

Outcome run(const TolerableOptions& options) {
  auto reader = TraceReader::open(options.input);
  if (!reader) return refuse(options.input, reader.error());
  if (reader->info().users.empty())
    return refuse(shown_path(options.input) + ": nobody is in this recording", "Give one with a user, as `tactus sim` makes.");
  DelayTolerance tolerance(reader->info(), options.weber);
  Progress progress("tolerable", reader->frame_count(), options.common.progress());
  TraceFrame frame;
  std::uint64_t read = 0;
  for (;; ++read) {
    const auto more = reader->next(frame);
    if (!more) return refuse(options.input, more.error());
    if (!*more) break;
    tolerance.add(frame);
    progress.update(read + 1);
  }
  TACTUS_CHECK(check_ending(options.input, *reader, read));
  if (tolerance.touches().empty())
    return refuse(shown_path(options.input) + ": nobody touches anything", "Give a recording with contacts.");
  if (options.common.json) fmt::print("{}\n", text_of_json(to_json(options, reader->info(), tolerance)));
  else if (!options.common.quiet) print_text(options, reader->info(), tolerance);
  return {};
}

}  // namespace

void setup_tolerable(Command& app, Action& action) {
  auto options = std::make_shared<TolerableOptions>();
  Command& command = app.add_command("tolerable", "Tell how much delay the touches of a recording bear until it is felt");
  command.add_option("TRACE", options->input, "Recording with contacts (MCAP), - is standard input")->type_name("")->required();
  add_quantity(command, "-c,--weber-fraction", options->weber, Dimension::fraction, "Change of the force that is just felt [10%]")
      ->check(above_zero(Dimension::fraction));
  add_report_options(command, options->common);
  command.footer(
      "A client learns of an object's motion a round trip late. Meanwhile a hand that presses goes further into what the client\n"
      "shows, and feels more than at the server (thesis eqs. 4.17 to 4.20, 4.31).\n"
      "Example:\n  tactus sim push-1dof -o push.mcap && tactus tolerable push.mcap");
  on_chosen<TolerableOptions>(command, action, options, run);
}

}  // namespace tactus::cli
