// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <string_view>

#include <tactus/base/shown.h>
#include <tactus/trace/csv.h>
#include <tactus/trace/csv_plan.h>
#include "cli/report/report.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

struct ImportOptions {
  std::string input, output, preset;
  std::vector<std::string> maps;
  std::string object, user, time, segment;
  std::optional<AngularVelocityFrame> angular_velocity_frame;
  double length_scale = -1;  // [m] below 0: not given
  std::uint32_t tick_rate = 0;
  bool list_presets = false;
  CommonOptions common;
};

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',') parts.emplace_back();
    else parts.back() += c;
  }
  return parts;
}

/// "position=x,y,z" into the mapping.
Outcome apply_map(const std::string& text, CsvMapping& mapping) {
  const std::map<std::string, std::span<std::string>> targets{
      {"position", mapping.position}, {"rotation", mapping.rotation},
      {"velocity", mapping.velocity}, {"angular_velocity", mapping.angular_velocity},
      {"device", mapping.device},     {"force", mapping.force}};
  const std::size_t equals = text.find('=');
  const auto target = targets.find(text.substr(0, equals));
  if (equals == std::string::npos || target == targets.end()) {
    return refuse_arguments("--map '" + text + "': not QUANTITY=COLUMNS",
                            "Quantities are position, rotation (w,x,y,z), velocity, angular_velocity, device and force.");
  }
  const auto columns = split(text.substr(equals + 1));
  if (columns.size() != target->second.size()) {
    return refuse_arguments(
        fmt::format("--map '{}': {} columns where {} needs {}", text, columns.size(), target->first, target->second.size()),
        "Name the columns as the first line of the file does, with commas between; 0 stands for one that it lacks.");
  }
  std::copy(columns.begin(), columns.end(), target->second.begin());
  return {};
}

tl::expected<CsvMapping, Failure> make_mapping(const ImportOptions& options) {
  CsvMapping mapping;
  if (!options.preset.empty()) {
    const auto& presets = csv_presets();
    const auto found = std::find_if(presets.begin(), presets.end(), [&](const CsvPreset& p) { return options.preset == p.name; });
    if (found == presets.end())
      return refuse_arguments("--preset " + options.preset + ": no such preset",
                              "`tactus import csv --list-presets` names them.");
    mapping = found->mapping;
  }
  std::set<std::string> mapped;
  for (const std::string& map : options.maps) {
    const std::string quantity = map.substr(0, map.find('='));
    if (!mapped.insert(quantity).second)
      return refuse_arguments(fmt::format("--map '{}': {} is mapped twice", map, quantity), "Give every quantity once.");
    TACTUS_CHECK(apply_map(map, mapping));
  }
  if (!options.object.empty()) mapping.object = options.object;
  if (!options.user.empty()) mapping.user = options.user;
  if (!options.time.empty()) mapping.time = options.time;
  if (!options.segment.empty()) mapping.segment = options.segment;
  if (options.length_scale == 0) return refuse_arguments("--length-unit: not above 0", "Give a length, such as 1mm.");
  if (options.length_scale > 0) mapping.length_scale = options.length_scale;
  if (options.tick_rate > 0) mapping.tick_rate = options.tick_rate;
  if (options.angular_velocity_frame) {
    if (mapping.angular_velocity.front().empty())
      return refuse_arguments("--angular-velocity-frame: no angular velocity is read",
                              "Name its columns with --map angular_velocity=X,Y,Z, or leave the option out.");
    mapping.angular_velocity_frame = *options.angular_velocity_frame;
  }
  if (options.preset.empty() && options.maps.empty()) mapping.layout = CsvLayout::tactus;  // a table of `export csv` names itself
  return mapping;
}

/// Whether a mapping cannot be right for any table. What layout `tactus` lacks is the table's fault.
bool blames_arguments(const CsvMapping& mapping, std::string_view rule) {
  if (mapping.layout != CsvLayout::named_columns) return false;
  return rule == "R-CSV-8" || rule == "R-TRC-17" || (rule == "R-CSV-7" && mapping.time.empty());
}

tl::unexpected<Failure> refuse_csv(const ImportOptions& options, const CsvMapping& mapping, const Diagnostic& e) {
  const std::string& file = options.input;
  if (options.preset.empty() && options.maps.empty() && e.error.rule == std::string_view("R-CSV-2") &&
      e.detail == place_of_field("tick", ""))
    return refuse_arguments(file + ": no columns are given",
                            "Give --preset NAME or --map position=x,y,z. Only tables of `tactus export csv` need neither.");
  const bool arguments = blames_arguments(mapping, e.error.rule);
  auto refused = refuse(file, arguments ? e.detail : place_of(e), e.error);
  if (arguments) refused.value().cause = Failure::Cause::arguments;
  return refused;
}

/// What speaks against the angular velocities of a table.
std::string contradiction(const AngularVelocityCheck& angular_velocity, AngularVelocityFrame frame) {
  const bool is_body = frame == AngularVelocityFrame::body;
  std::string text =
      fmt::format("in the {} frame, the angular velocities do not match the rotations: mean error {:.3g} rad/s of {:.3g} rad/s",
                  is_body ? "body" : "world", angular_velocity.off, angular_velocity.given);
  if (angular_velocity.off_other < 0.5 * angular_velocity.off) {
    text += fmt::format("; in the {0} frame it is {1:.3g} rad/s: give --angular-velocity-frame {0}", is_body ? "world" : "body",
                        angular_velocity.off_other);
  }
  return text;
}

void list_presets() {
  for (const CsvPreset& preset : csv_presets()) fmt::print("{:<24} {}\n", preset.name, preset.description);
}

Outcome run(const ImportOptions& options) {
  TACTUS_CHECK(check_no_terminal(options.output));
  if (options.list_presets) {
    list_presets();
    return {};
  }
  TACTUS_TRY(const auto mapping, make_mapping(options));
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input}));
  Report report{.command = "import csv", .files = {{"table", options.input}, {"trace", options.output}}};
  report.timings = {{"import"}};
  const auto imported =
      report.timings[0].times.measure([&] { return import_csv(options.input, mapping, output.working_path()); });
  if (!imported) return refuse_csv(options, mapping, imported.error());
  if (output.is_temporary()) {
    const auto reader = TraceReader::open(output.working_path());
    if (!reader) return refuse(options.output, reader.error());
    report.describe(reader->info());
  }
  report.ticks = imported->ticks;
  report.segments = imported->segments;
  if (imported->angular_velocity.is_off()) {
    report.warnings.push_back(contradiction(imported->angular_velocity, mapping.angular_velocity_frame));
    fmt::print(stderr, "warning: {}: {}\n", shown_path(options.input), report.warnings.back());
  }
  TACTUS_CHECK(output.keep());
  print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_import(Command& app, Action& action) {
  auto options = std::make_shared<ImportOptions>();
  Command& group = app.add_command("import", "Convert a recording to a trace");
  group.footer("Example:\n  tactus import csv tosses.csv.zst --preset cube-tosses -o tosses.mcap");
  Command& command = group.add_command("csv", "A table with one row per sample, plain or zstd");
  Option* list = command.add_flag("--list-presets", options->list_presets, "List the built-in column mappings");
  Option* input = command.add_option("FILE", options->input, "Table to read, - is standard input")->type_name("");
  Option* output =
      command.add_option("-o,--output", options->output, "Trace to write (MCAP), - is standard output")->type_name("FILE");
  command.add_option("--preset", options->preset, "Built-in column mapping")->type_name("NAME");
  command
      .add_option("--map", options->maps,
                  "Columns of one quantity, such as position=x,y,z, or device=x,y,0 of a plane; may be repeated")
      ->one_value()
      ->type_name("QUANTITY=COLUMNS");
  command.add_option("--time", options->time, "Column with the time in seconds")->type_name("COLUMN");
  command.add_option("--segment", options->segment, "Column that separates the recordings of a table")->type_name("COLUMN");
  command.add_option("--object", options->object, "Name of the object")->type_name("NAME");
  command.add_option("--user", options->user, "Name of the user")->type_name("NAME");
  add_quantity(command, "--length-unit", options->length_scale, Dimension::length, "Metres per unit of the table's lengths [1m]");
  command.add_option("--tick-rate", options->tick_rate, "Samples per second [from the times]")
      ->check(whole_number(1, 1000000))
      ->type_name("HZ");
  command
      .add_option(
          "--angular-velocity-frame",
          [&frame = options->angular_velocity_frame](const std::string& name) {
            frame = name == "body" ? AngularVelocityFrame::body : AngularVelocityFrame::world;
          },
          "Frame of the angular velocities: world or body [the preset's, or world]")
      ->one_of({"world", "body"})
      ->type_name("FRAME");
  add_output_options(command, options->common);
  command.footer(
      "Examples:\n"
      "  tactus import csv tosses.csv.zst --preset cube-tosses -o tosses.mcap\n"
      "  tactus import csv arm.csv --time t --map position=x,y,z --map rotation=qw,qx,qy,qz -o arm.mcap\n"
      "Fields are separated by the semicolons, tabs or commas of the first line; lines that begin with # or % are comments.\n"
      "Segments are joined without a gap. A pause inside a segment is kept: its ticks are missing, but its time counts.");
  command.on_chosen([&action, options, list, input, output] {
    if (list->count() == 0 && input->count() == 0) miss_option("FILE");
    if (list->count() == 0 && output->count() == 0) miss_option("--output");
    action = [options] { return run(*options); };
  });
}

}  // namespace tactus::cli
