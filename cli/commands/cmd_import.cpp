// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <span>
#include <string_view>

#include <tactus/base/shown.h>
#include <tactus/trace/csv.h>
#include <tactus/trace/csv_plan.h>
#include "cli/options/contact_option.h"
#include "cli/report/notes.h"
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
  std::string time_unit, angle_unit, force_unit, quaternion_order, euler_order, date_order, axes, object_column, names;
  std::vector<std::string> missing;
  std::uint32_t skip_lines = 0;
  double gap = -1;  // [s] below 0: not given
  bool no_resample = false, restarts = false, strict = false, keep_last = false, skip_bad = false;
  ContactArguments contacts;
  CommonOptions common;
};

/// At commas; a part in quotes may hold some, as in a line of the table.
std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> parts(1);
  bool is_quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' && is_quoted && text.substr(i + 1).starts_with('"')) parts.back() += text[++i];
    else if (c == '"' && (is_quoted || parts.back().empty())) is_quoted = !is_quoted;
    else if (c == ',' && !is_quoted) parts.emplace_back();
    else parts.back() += c;
  }
  return parts;
}

/// The object or user that "cup.position" is of, and its quantity.
CsvQuantities& subject_of(std::string& quantity, CsvMapping& mapping) {
  const std::size_t dot = quantity.rfind('.');
  if (dot == std::string::npos || dot == 0) return mapping;
  const std::string name = quantity.substr(0, dot);
  quantity.erase(0, dot + 1);
  const auto is_it = [&](const CsvSubject& subject) { return subject.name == name; };
  const auto found = std::find_if(mapping.others.begin(), mapping.others.end(), is_it);
  if (found != mapping.others.end()) return *found;
  mapping.others.emplace_back().name = name;
  return mapping.others.back();
}

/// "position=x,y,z" or "cup.position=x,y,z" into the mapping.
Outcome apply_map(const std::string& text, CsvMapping& mapping) {
  const std::size_t equals = text.find('=');
  std::string quantity = text.substr(0, equals);
  const std::string whole = quantity;
  CsvQuantities& subject = subject_of(quantity, mapping);
  const std::map<std::string, std::span<std::string>> targets{{"position", subject.position},
                                                              {"rotation", subject.rotation},
                                                              {"euler", subject.euler},
                                                              {"rotation_vector", subject.rotation_vector},
                                                              {"rotation_matrix", subject.rotation_matrix},
                                                              {"velocity", subject.velocity},
                                                              {"angular_velocity", subject.angular_velocity},
                                                              {"device", subject.device},
                                                              {"device_rotation", subject.device_rotation},
                                                              {"device_euler", subject.device_euler},
                                                              {"device_rotation_vector", subject.device_rotation_vector},
                                                              {"device_rotation_matrix", subject.device_rotation_matrix},
                                                              {"force", subject.force}};
  const auto target = targets.find(quantity);
  if (equals == std::string::npos || target == targets.end()) {
    return refuse_arguments(
        "--map '" + text + "': not QUANTITY=COLUMNS",
        "Quantities are position, rotation (w,x,y,z), euler, rotation_vector, rotation_matrix, velocity, "
        "angular_velocity, device, device_rotation (or device_euler and so on) and force; with several objects NAME.position.");
  }
  const auto columns = split(std::string_view(text).substr(equals + 1));
  if (columns.size() != target->second.size()) {
    return refuse_arguments(
        fmt::format("--map '{}': {} columns where {} needs {}", text, columns.size(), whole, target->second.size()),
        "Name the columns as the table does, with commas between (in quotes where a name has one), or by number, #1; 0 stands "
        "for one "
        "that it lacks.");
  }
  std::copy(columns.begin(), columns.end(), target->second.begin());
  return {};
}

/// "x,-z,y", or words: "y-up", "left-handed" or both.
tl::expected<std::array<std::int8_t, 3>, Failure> read_axes(const std::string& text) {
  const auto parts = split(text);
  const bool y_up = std::ranges::find(parts, "y-up") != parts.end(),
             left = std::ranges::find(parts, "left-handed") != parts.end();
  const auto is_word = [](const std::string& part) { return part == "y-up" || part == "z-up" || part == "left-handed"; };
  using Axes = std::array<std::int8_t, 3>;
  if (std::ranges::all_of(parts, is_word))
    return y_up ? (left ? Axes{1, 3, 2} : Axes{1, -3, 2}) : left ? Axes{1, -2, 3} : Axes{1, 2, 3};
  Axes axes{};
  std::set<char> used;
  for (std::size_t i = 0; i < 3 && parts.size() == 3; ++i) {
    const bool is_minus = parts[i].starts_with('-');
    const std::string axis = parts[i].substr(is_minus || parts[i].starts_with('+') ? 1 : 0);
    if (axis != "x" && axis != "y" && axis != "z") break;
    used.insert(axis[0]);
    axes[i] = static_cast<std::int8_t>((axis[0] - 'x' + 1) * (is_minus ? -1 : 1));
  }
  if (used.size() == 3) return axes;
  return refuse_arguments("--axes '" + text + "': not three axes",
                          "Say what x, y and z of the trace are in the table: x,-z,y, or y-up, left-handed or both.");
}

/// What says how numbers and lines are meant.
Outcome apply_meaning(const ImportOptions& options, CsvMapping& mapping) {
  mapping.time_unit = options.time_unit;
  mapping.angle_unit = options.angle_unit;
  mapping.force_unit = options.force_unit;
  mapping.euler_order = options.euler_order;
  if (options.quaternion_order == "wxyz") mapping.quaternion_order = QuaternionOrder::wxyz;
  if (options.quaternion_order == "xyzw") mapping.quaternion_order = QuaternionOrder::xyzw;
  if (options.date_order == "mdy") mapping.date_order = CsvDateOrder::mdy;
  if (options.date_order == "dmy") mapping.date_order = CsvDateOrder::dmy;
  if (!options.axes.empty()) {
    TACTUS_TRY(mapping.axes, read_axes(options.axes));
  }
  mapping.object_column = options.object_column;
  if (options.names == "none") mapping.text.names = CsvNames::none;
  if (options.names == "first") mapping.text.names = CsvNames::first;
  mapping.text.skip_lines = options.skip_lines;
  mapping.missing = options.missing;
  if (options.gap == 0) return refuse_arguments("--gap: not above 0", "Give a time, such as 100ms.");
  if (options.gap > 0) mapping.gap = options.gap;
  mapping.resample = !options.no_resample;
  mapping.restarts = options.restarts;
  mapping.contacts = options.contacts.declared();
  mapping.strict = options.strict;
  mapping.keep_last = options.keep_last;
  mapping.skip_bad = options.skip_bad;
  return {};
}

/// Options that say nothing about what is mapped would be ignored.
Outcome check_used(const ImportOptions& options, const CsvMapping& mapping) {
  std::vector<const CsvQuantities*> all{&mapping};
  for (const CsvSubject& other : mapping.others) all.push_back(&other);
  const auto any = [&](auto has) { return std::ranges::any_of(all, [&](const CsvQuantities* q) { return has(*q); }); };
  const bool euler = any([](const CsvQuantities& q) { return !q.euler[0].empty() || !q.device_euler[0].empty(); });
  const bool angles =
      euler || any([](const CsvQuantities& q) {
        return !q.rotation_vector[0].empty() || !q.device_rotation_vector[0].empty() || !q.angular_velocity[0].empty();
      });
  const auto unused = [](const char* option, const char* why) {
    return refuse_arguments(std::string(option) + ": " + why, "Leave it out, or map what it is about.");
  };
  if (mapping.layout == CsvLayout::tactus) {
    const bool any_given = !options.time_unit.empty() || !options.angle_unit.empty() || !options.force_unit.empty() ||
                           !options.axes.empty() || !options.quaternion_order.empty() || !options.euler_order.empty() ||
                           !options.object_column.empty() || !options.missing.empty() || options.gap > 0 || options.no_resample ||
                           options.skip_bad || options.strict || options.restarts || !options.date_order.empty() ||
                           !mapping.contacts.empty();
    return any_given
               ? unused("tables of `tactus export csv`", "they say themselves what they hold; options of other tables do nothing")
               : Outcome();
  }
  if (!options.euler_order.empty() && !euler) return unused("--euler-order", "no Euler angles are mapped");
  if (!options.angle_unit.empty() && !angles) return unused("--angle-unit", "no angles are mapped");
  if (!options.quaternion_order.empty() &&
      !any([](const CsvQuantities& q) { return !q.rotation[0].empty() || !q.device_rotation[0].empty(); }))
    return unused("--quaternion-order", "no rotation of four numbers is mapped");
  if (!options.force_unit.empty() && !any([](const CsvQuantities& q) { return !q.force[0].empty(); }))
    return unused("--force-unit", "no force is mapped");
  const std::pair<const char*, bool> of_times[]{{"--time-unit", !options.time_unit.empty()},
                                                {"--date-order", !options.date_order.empty()},
                                                {"--no-resample", options.no_resample},
                                                {"--restarts", options.restarts}};
  for (const auto& [option, is_given] : of_times)
    if (mapping.time.empty() && is_given) return unused(option, "no column of time is named (--time COLUMN)");
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
  if (options.length_scale > 0) mapping.length_scale = options.length_scale, mapping.says_length = true;
  if (options.tick_rate > 0) mapping.tick_rate = options.tick_rate;
  if (options.angular_velocity_frame) {
    const bool others =
        std::ranges::any_of(mapping.others, [](const CsvSubject& other) { return !other.angular_velocity.front().empty(); });
    if (mapping.angular_velocity.front().empty() && !others)
      return refuse_arguments("--angular-velocity-frame: no angular velocity is read",
                              "Name its columns with --map angular_velocity=X,Y,Z, or leave the option out.");
    mapping.angular_velocity_frame = *options.angular_velocity_frame;
  }
  if (options.preset.empty() && options.maps.empty()) mapping.layout = CsvLayout::tactus;  // a table of `export csv` names itself
  TACTUS_CHECK(apply_meaning(options, mapping));
  TACTUS_CHECK(check_used(options, mapping));
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
      e.detail == location_of_field("tick", ""))
    return refuse_arguments(file + ": no columns are given",
                            "Give --preset NAME or --map position=x,y,z. Only tables of `tactus export csv` need neither.");
  const bool arguments = blames_arguments(mapping, e.error.rule);
  auto refused = refuse(file, arguments ? e.detail : location_of(e), e.error);
  if (!e.remedy.empty()) refused.value().remedy = e.remedy;
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

Outcome run_import(const ImportOptions& options) {
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
  report_notes(imported->notes.all(), options.input, report);
  if (imported->angular_velocity.is_off()) {
    report.warnings.push_back(contradiction(imported->angular_velocity, mapping.angular_velocity_frame));
    fmt::print(stderr, "warning: {}: {}\n", shown_path(options.input), report.warnings.back());
  }
  TACTUS_CHECK(output.keep());
  print(report, options.common, beside(options.output));
  return {};
}

/// How lines and numbers of a table are meant.
void add_text_options(Command& command, ImportOptions& options) {
  command
      .add_option(
          "--time-unit", options.time_unit,
          "Unit of the times [of the column's name, or s]; tick: they count ticks of --tick-rate; hhmmss: 123559.5 is 12:35:59.5")
      ->one_of({"s", "ms", "us", "ns", "min", "h", "day", kTickUnit, kClockUnit})
      ->type_name("UNIT");
  command.add_option("--angle-unit", options.angle_unit, "Unit of angles and of angular velocities [of the names]")
      ->one_of({"rad", "deg"})
      ->type_name("UNIT");
  command.add_option("--force-unit", options.force_unit, "Unit of forces [of the names, or N]")
      ->one_of({"N", "mN", "kN"})
      ->type_name("UNIT");
  command
      .add_option("--quaternion-order", options.quaternion_order,
                  "Order in which the columns of a rotation are listed [as they are called, or as the first one shows]")
      ->one_of({"wxyz", "xyzw"})
      ->type_name("ORDER");
  command.add_option("--date-order", options.date_order, "Which number of 05/06/2024 is the month [asked for where it matters]")
      ->one_of({"mdy", "dmy"})
      ->type_name("ORDER");
  command
      .add_option("--euler-order", options.euler_order,
                  "Axes in the order of turning: ZYX about turned axes, xyz about fixed ones")
      ->type_name("ORDER");
  command
      .add_option("--axes", options.axes, "What x, y and z of the trace are in the table: x,-z,y, or y-up, left-handed or both")
      ->type_name("AXES");
  command.add_option("--object-column", options.object_column, "Column that names the object of each row")->type_name("COLUMN");
  command.add_option("--skip-lines", options.skip_lines, "Lines to leave out ahead of the table")->type_name("N");
  command.add_option("--names", options.names, "Where the names are: auto, first line, or none (columns are #1, #2, ...) [auto]")
      ->one_of({"auto", "first", "none"})
      ->type_name("WHERE");
  command.add_option("--missing", options.missing, "Another text that means 'no value'; may be repeated")
      ->one_value()
      ->type_name("TEXT");
  add_quantity(command, "--gap", options.gap, Dimension::time,
               "Missing samples are put in between two so far apart [100ms, or 3 samples]");
  command.add_flag("--no-resample", options.no_resample, "Round times to ticks, and refuse two in one");
  command.add_flag("--restarts", options.restarts, "Where the time falls, the next recording begins");
  command.add_flag("--strict", options.strict, "Refuse what is missing, out of order, repeated or cut");
  command.add_flag("--keep-last", options.keep_last, "Take a last line that has no end");
  command.add_flag("--skip-bad", options.skip_bad, "Leave out rows that cannot be read");
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
                  "Columns of one quantity: position, rotation (w,x,y,z), euler, rotation_vector, rotation_matrix, velocity, "
                  "angular_velocity, "
                  "device, device_rotation (or device_euler, and so on) or force, such as position=x,y,z, device=x,y,0 of a "
                  "plane, cup.position=#2,#3,#4 of "
                  "one of several "
                  "objects; may "
                  "be repeated")
      ->one_value()
      ->type_name("QUANTITY=COLUMNS");
  command
      .add_option("--time", options->time,
                  "Column with the time: a number, a date with a time of day, or a time of day; or two columns, as date,time or "
                  "sec,nanosec")
      ->type_name("COLUMN");
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
  add_text_options(command, *options);
  options->contacts.add_to(command);
  add_output_options(command, options->common);
  command.footer(
      "Examples:\n"
      "  tactus import csv tosses.csv.zst --preset cube-tosses -o tosses.mcap\n"
      "  tactus import csv arm.csv --time t --map position=x,y,z --map rotation=qw,qx,qy,qz -o arm.mcap\n"
      "  tactus import csv tum.txt --time timestamp --map position=tx,ty,tz --map rotation=qx,qy,qz,qw -o tum.mcap\n"
      "  tactus import csv euroc.csv --time 'timestamp [ns]' --map position=p_x,p_y,p_z --map rotation=q_w,q_x,q_y,q_z -o "
      "euroc.mcap\n"
      "  tactus import csv optitrack.csv --time 'Time (Seconds)' --map 'position=Position X,Position Y,Position Z' --axes y-up "
      "-o cup.mcap\n"
      "  tactus import csv savetxt.txt --time '#1' --map 'position=#2,#3,#4' --map 'force=#5,#6,#7' -o hand.mcap\n"
      "  tactus import csv arm.csv --time t --map position=x,y,z --map force=fx,fy,fz --contact user=object,k=500N/m,at=origin "
      "-o arm.mcap\n"
      "  tactus import csv two.csv --time t_ms --map cup.position=cx,cy,cz --map lid.position=lx,ly,lz -o two.mcap\n"
      "Commas, semicolons, tabs or blanks separate fields; lines that begin with #, % or // are comments. Units are read from "
      "names (t_ms,\n"
      "'x [mm]', yaw_deg). Segments are joined without a gap. A pause inside a segment is kept: its ticks are missing, but its "
      "time counts.\n"
      "What was decided where a table leaves it open is reported in notes.");
  command.on_chosen([&action, options, list, input, output] {
    if (list->count() == 0 && input->count() == 0) miss_option("FILE");
    if (list->count() == 0 && output->count() == 0) miss_option("--output");
    action = [options] { return run_import(*options); };
  });
}

}  // namespace tactus::cli
