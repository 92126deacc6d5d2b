// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <filesystem>

#include <tactus/base/shown.h>
#include <tactus/base/text.h>
#include <tactus/sim/surface/surface_file.h>
#include <tactus/sim/surface/surface_sequence.h>
#include <tactus/trace/messages.h>
#include <tactus/trace/trace_file.h>
#include "cli/commands/commands.h"
#include "cli/commands/input.h"
#include "cli/options/option_needs.h"
#include "cli/report/notes.h"
#include "cli/report/report.h"
#include "cli/report/table.h"

namespace tactus::cli {

// ==== cmd import mesh ====

namespace {

struct ImportMeshOptions {
  std::string input, output, series, node, animation, axes, name = "mesh";
  double rate = 60;        // [Hz]
  double period = 0;       // [s], 0: that of the rate
  double length_unit = 1;  // [m]
  bool drop_degenerate = false;
  CommonOptions common;
};

sim::Axes axes_of(const std::string& text) {
  return text == "y-up" ? sim::Axes::y_up : text == "z-up" ? sim::Axes::z_up : sim::Axes::as_the_format_says;
}

double period_of(const ImportMeshOptions& options) { return options.period > 0 ? options.period : 1 / options.rate; }

/// When frames come: in ticks of a whole number per second.
struct Clock {
  std::uint32_t tick_rate = 0;
  double period = 1;  // [ticks]
};

/// True if every frame falls on a whole tick, `period` ticks from one number to the next.
bool fits(const sim::SurfaceSequence& sequence, double period) {
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    const double ticks = sequence.offset(k) * period, whole = std::round(ticks);
    if (std::abs(ticks - whole) > 1e-6 * std::max(whole, 1.0)) return false;
  }
  return period >= 0.5 && std::abs(period - std::round(period)) < 1e-6 * period;
}

/// The slowest of the usual clocks on whose ticks every frame falls; where none is found, the fastest.
Clock clock_of(const ImportMeshOptions& options, const sim::SurfaceSequence& sequence) {
  const double period = period_of(options);
  if (const double rate = std::round(1 / period); rate >= 1 && std::abs(rate * period - 1) < 1e-9 && fits(sequence, 1))
    return {static_cast<std::uint32_t>(rate), 1};
  for (const std::uint32_t rate : {1000u, 10'000u, 100'000u, kMaxTickRate})
    if (fits(sequence, period * rate)) return {rate, std::round(period * rate)};
  return {kMaxTickRate, period * kMaxTickRate};
}

/// An animation in one file is none that is read here; what turns it into one that is.
Outcome check_folder(const std::string& input) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(input, ignored)) return {};
  std::string ending = std::filesystem::path(input).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<std::pair<const char*, const char*>, 7> kKnown{{{".fbx", "an FBX scene"},
                                                                       {".abc", "an Alembic cache"},
                                                                       {".blend", "a Blender file"},
                                                                       {".usd", "a USD scene"},
                                                                       {".usda", "a USD scene"},
                                                                       {".usdc", "a USD scene"},
                                                                       {".usdz", "a USD scene"}}};
  const auto known = std::find_if(kKnown.begin(), kKnown.end(), [&](const auto& k) { return ending == k.first; });
  if (known == kKnown.end()) return {};
  return refuse(fmt::format("{}: {}, not a folder of frames", shown_path(input), known->second),
                "In Blender: import or open it, then File, Export, glTF 2.0 (.glb), and give that file; or Wavefront (.obj) with "
                "Animation ticked, and give the folder of these files.");
}

/// What is kept of a frame is its distance from the first.
Outcome write_frames(const sim::SurfaceSequence& sequence, const TriMesh& rest, const ImportMeshOptions& options,
                     const Clock& clock, TraceWriter& writer, Report& report) {
  TraceFrame frame;
  frame.meshes.resize(1);
  frame.meshes[0].updated = true;
  frame.meshes[0].displacements.resize(3 * rest.vertices.size());
  Progress progress("import", sequence.size(), options.common.progress());
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    const auto positions = report.timings[0].times.measure([&] { return sequence.positions(k); });
    if (!positions) return refuse(positions.error());
    const std::int64_t tick = std::llround(sequence.offset(k) * clock.period);
    if (k > 0 && tick <= frame.tick)
      return refuse(fmt::format("{} and {}: on one tick", shown_path(sequence.file(k - 1)), shown_path(sequence.file(k))),
                    "Give a lower --rate, or take one of them out of the folder.");
    frame.tick = tick;
    float* out = frame.meshes[0].displacements.data();
    for (std::size_t v = 0; v < positions->size(); ++v) {
      const Vec3 u = options.length_unit * (*positions)[v] - rest.vertices[v];
      for (const double c : {u.x, u.y, u.z}) *out++ = static_cast<float>(c);
    }
    if (const auto written = writer.write(frame); !written)
      return refuse(options.output, location_of_tick(frame.tick), written.error());
    report.ticks.add(frame.tick);
    progress.update(k + 1);
  }
  return {};
}

std::string name_mistake(const std::string& name) {
  if (is_plain_name(name)) return "";
  return fmt::format("'{}': a name has 1 to 255 bytes of UTF-8 without '/' and control characters", shown(name));
}

Outcome run_import_mesh(const ImportMeshOptions& options) {
  TACTUS_CHECK(check_no_terminal(options.output));
  TACTUS_CHECK(check_folder(options.input));
  const bool is_gltf = options.input.ends_with(".glb") || options.input.ends_with(".gltf");
  note_idle_options(*options.common.command, {Subject::surface, Subject::deformed, is_gltf ? Subject::gltf : Subject::frames},
                    "input");
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing()));
  const auto sequence = sim::SurfaceSequence::open(options.input, {.series = options.series,
                                                                   .drop_degenerate = options.drop_degenerate,
                                                                   .axes = axes_of(options.axes),
                                                                   .node = options.node,
                                                                   .animation = options.animation,
                                                                   .period = period_of(options)});
  if (!sequence) return refuse(sequence.error());
  TriMesh rest = sequence->rest();
  for (Vec3& p : rest.vertices) p = options.length_unit * p;
  const Clock clock = clock_of(options, *sequence);
  const TraceInfo info{.tick_rate = clock.tick_rate,
                       .objects = {},
                       .users = {},
                       .source = "import " + options.input,
                       .scene = {},
                       .meshes = {{.name = options.name, .rest = rest, .period = clock.period}}};
  auto writer = TraceWriter::create(output.working_path(), info);
  if (!writer) return refuse(options.output, writer.error());
  Report report{.command = "import mesh", .files = {{"frames", options.input}, {"trace", options.output}}};
  report.timings = {{"read"}};
  report_notes(sequence->notes(), options.input, report);
  TACTUS_CHECK(write_frames(*sequence, rest, options, clock, *writer, report));
  if (const auto finished = writer->finish(); !finished) return refuse(options.output, finished.error());
  report.describe(info);
  report.meshes.push_back({.name = options.name,
                           .vertices = rest.vertices.size(),
                           .triangles = rest.triangles.size(),
                           .frames = sequence->size(),
                           .frame_period = clock.period / clock.tick_rate});
  TACTUS_CHECK(output.keep());
  print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_import_mesh(Command& group, Action& action) {
  auto options = std::make_shared<ImportMeshOptions>();
  Command& command = group.add_command("mesh", "A mesh that moves: a folder of OBJ, PLY or OFF files, or a glTF scene");
  command
      .add_option("FRAMES", options->input,
                  "Folder, one file per frame, in the order of the numbers in their names; or .glb, .gltf")
      ->type_name("")
      ->required();
  command.add_option("-o,--output", options->output, "Trace to write (MCAP), - is standard output")
      ->type_name("FILE")
      ->required();
  Option* rate =
      command.add_option("--rate", options->rate, "Frames per second [60]")->check(number(0.001, 1e6))->type_name("HZ");
  add_quantity(command, "--period", options->period, Dimension::time, "Frame period, instead of --rate")
      ->check(within(Dimension::time, "1us", "1000s"))
      ->excludes(rate);
  add_quantity(command, "--length-unit", options->length_unit, Dimension::length, "Metres per unit of the files' lengths [1m]")
      ->check(within(Dimension::length, "1um", "1000000m"));
  command.add_option("--series", options->series, "Take the frames whose names have this form, * stands for anything [all]")
      ->type_name("PATTERN");
  command.add_option("--animation", options->animation, "Animation of a glTF scene [the only one]")->type_name("NAME");
  add_scene_options(command, options->node, options->axes);
  command.add_flag("--drop-degenerate", options->drop_degenerate, "Leave out faces that have no area in the first frame");
  command.add_option("--name", options->name, "Name of the mesh [mesh]")->check(name_mistake)->type_name("NAME");
  add_output_options(command, options->common);
  command.footer(
      "Examples:\n"
      "  tactus import mesh horse/ --rate 30 --length-unit 1mm -o horse.mcap\n"
      "  tactus import mesh shapes/ --period 17ms -o membrane.mcap\n"
      "  tactus import mesh clip.glb --node Hand --rate 120 -o hand.mcap");
  on_chosen<ImportMeshOptions>(command, action, options, run_import_mesh);
}

// ==== cmd export mesh ====

namespace {

namespace fs = std::filesystem;

struct ExportMeshOptions {
  std::string input, output, mesh, format = "obj";
  CommonOptions common;
};

/// The folder to make, without the trailing slash of shell completion.
tl::expected<fs::path, Failure> target_of(const std::string& output) {
  fs::path path = fs::path(output).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  std::error_code ignored;
  const bool is_new = path.has_filename() && path != "." && path.filename() != "..";
  if (!is_new)
    return refuse_arguments(shown_path(output) + ": not the name of a new folder", "Name a folder that does not exist yet.");
  const fs::file_status status = fs::symlink_status(path, ignored);
  if (!fs::exists(status) || (fs::is_directory(status) && fs::is_empty(path, ignored))) return path;
  return refuse(shown_path(output) + ": already exists", "Name a folder that is empty or does not exist yet.");
}

tl::expected<std::size_t, Failure> find_mesh(const ExportMeshOptions& options, const TraceInfo& info) {
  const auto found = std::find_if(info.meshes.begin(), info.meshes.end(),
                                  [&](const TraceDeformable& m) { return options.mesh.empty() || m.name == options.mesh; });
  if (info.meshes.empty()) return refuse(shown_path(options.input) + ": no mesh in it", "Give a trace of a deformable object.");
  if (found == info.meshes.end()) return refuse("--mesh " + shown(options.mesh) + ": no such mesh", "`tactus info` names them.");
  if (options.mesh.empty() && info.meshes.size() > 1)
    return refuse(fmt::format("{}: {} meshes in it", shown_path(options.input), info.meshes.size()),
                  "Choose one with --mesh NAME.");
  return static_cast<std::size_t>(found - info.meshes.begin());
}

Outcome run_export_mesh(const ExportMeshOptions& options) {
  auto reader = open_trace(options.input, options.common.progress());
  if (!reader) return tl::unexpected(reader.error());
  TACTUS_TRY(const auto index, find_mesh(options, reader->info()));
  TACTUS_TRY(const auto target, target_of(options.output));
  const std::string parent = target.has_parent_path() ? target.parent_path().string() : ".";
  std::error_code failed;
  fs::create_directories(parent, failed);
  TACTUS_TRY(auto folder, AsideFolder::create(parent, target.filename().string()));
  const TriMesh& rest = reader->info().meshes[index].rest;
  TriMesh shape = rest;
  TraceFrame frame;
  Report report{.command = "export mesh", .files = {{"trace", options.input}, {"frames", options.output}}};
  report.timings = {{"write"}};
  std::uint64_t count = 0;
  while (true) {
    TACTUS_TRY(const bool more, next_frame(*reader, frame, options.input));
    if (!more) break;
    report.ticks.add(frame.tick);
    if (!frame.meshes[index].updated) continue;
    const std::vector<float>& u = frame.meshes[index].displacements;
    for (std::size_t v = 0; v < shape.vertices.size(); ++v)
      shape.vertices[v] = rest.vertices[v] + Vec3{u[3 * v], u[3 * v + 1], u[3 * v + 2]};
    const std::string file = fmt::format("{}/frame-{:06}.{}", folder.path(), count++, options.format);
    errno = 0;
    const auto written = report.timings[0].times.measure([&] { return sim::write_surface(file, shape); });
    if (!written && written.error().error.code == Errc::io) return refuse_io(options.output, "cannot be written", errno);
    if (!written) return refuse(written.error());
  }
  TACTUS_CHECK(check_ending(options.input, *reader, report.ticks.count()));
  TACTUS_CHECK(folder.keep_as(target.string()));
  const TraceInfo& info = reader->info();
  report.describe(info);
  report.meshes.push_back({.name = info.meshes[index].name,
                           .vertices = rest.vertices.size(),
                           .triangles = rest.triangles.size(),
                           .frames = count,
                           .frame_period = info.meshes[index].period / info.tick_rate});
  print(report, options.common, Destination::standard_output);
  return {};
}

}  // namespace

void setup_export_mesh(Command& group, Action& action) {
  auto options = std::make_shared<ExportMeshOptions>();
  Command& command =
      group.add_command("mesh", "A folder of OBJ or PLY files, frame-000000 and on, one for every new shape of a mesh");
  command.add_option("TRACE", options->input, "Trace to export (MCAP), - is standard input")->type_name("")->required();
  command.add_option("-o,--output", options->output, "Folder to create")->type_name("FOLDER")->required();
  command.add_option("--mesh", options->mesh, "Name of the mesh [the only one]")->type_name("NAME");
  command.add_option("--format", options->format, "Kind of files: obj or ply [obj]")->one_of({"obj", "ply"})->type_name("");
  add_report_options(command, options->common);
  command.footer("Example:\n  tactus export mesh replica.mcap --format ply -o shapes");
  on_chosen<ExportMeshOptions>(command, action, options, run_export_mesh);
}

}  // namespace tactus::cli
