// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <tactus/base/shown.h>
#include <tactus/trace/csv.h>
#include <tactus/trace/foxglove_writer.h>
#include <tactus/trace/trace_file.h>
#include "cli/commands/commands.h"
#include "cli/commands/input.h"
#include "cli/commands/viewer_layout.h"
#include "cli/options/units.h"
#include "cli/report/report.h"

#ifdef TACTUS_HAS_SIM
#include <tactus/sim/scene/scene.h>
#endif

namespace tactus::cli {

// ==== cmd export ====

namespace {

struct ExportOptions {
  std::string input, output = "-";
  CommonOptions common;
};

Outcome run_export(const ExportOptions& options) {
  auto reader = open_trace(options.input, options.common.progress());
  if (!reader) return tl::unexpected(reader.error());
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input}));
  TACTUS_TRY(const auto stream, output.open());
  Report report{.command = "export csv", .files = {{"trace", options.input}, {"table", options.output}}};
  report.timings = {{"export"}};
  const auto rows = report.timings[0].times.measure([&] { return export_csv(*reader, *stream); });
  if (!rows && stream->fail()) return refuse(options.output, rows.error());
  if (!rows) return refuse(options.input, reader->explain(rows.error()));
  TACTUS_CHECK(check_ending(options.input, *reader, rows->count()));
  TACTUS_CHECK(output.keep());
  report.describe(reader->info());
  report.ticks = *rows;
  if (options.common.json || options.output != "-") print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_export(Command& app, Action& action) {
  auto options = std::make_shared<ExportOptions>();
  Command& group = app.add_command("export", "Write a trace in another format");
  group.footer("Example:\n  tactus export csv push.mcap -o push.csv");
  Command& command = group.add_command(
      "csv", "One row per tick, numbers in the shortest digits that read back equal; rigid objects and users, no meshes");
  command.add_option("TRACE", options->input, "Trace to export (MCAP), - is standard input")->type_name("")->required();
  command.add_option("-o,--output", options->output, "CSV to write [standard output]")->type_name("FILE");
  add_output_options(command, options->common);
  command.footer(
      "A force that the trace does not know has no columns: serve does not receive the force at a hand; join, capture and play "
      "know\n"
      "nothing else.\n"
      "Example:\n  tactus export csv push.mcap -o push.csv");
  on_chosen<ExportOptions>(command, action, options, run_export);
}

// ==== cmd export foxglove ====

namespace {

struct ExportFoxgloveOptions {
  std::string input, output, scene, layout;
  FoxgloveOptions foxglove;
  CommonOptions common;
};

using Shapes = std::vector<FoxgloveShape>;

#ifdef TACTUS_HAS_SIM
constexpr Vec3 kPlate{0.1, 0.1, 0.1};  // [m] of a one-dimensional object, which has no size

/// In the order of the trace; an object that the scene lacks has no shape.
Shapes shapes_of(const sim::Scene& scene, const TraceInfo& info) {
  Shapes out(info.objects.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::string& name = info.objects[i].name;
    for (const sim::SceneObject& object : scene.objects)
      if (object.name == name) out[i] = {object.size, object.surface};
    for (const sim::SceneMsd& msd : scene.msds)
      if (msd.name == name) out[i].box = kPlate;
  }
  return out;
}

/// Of the scene that was named, or that of the trace.
tl::expected<Shapes, Failure> shapes_of(const ExportFoxgloveOptions& options, const TraceInfo& info) {
  if (!options.scene.empty()) {
    const auto path = sim::find_scene(options.scene);
    if (!path) return refuse(path.error());
    const auto scene = sim::load_scene(*path);
    if (!scene) return refuse(scene.error());
    return shapes_of(*scene, info);
  }
  if (info.scene.empty() || info.objects.empty()) return Shapes();
  const auto scene = sim::parse_attached_scene(info.scene);
  if (scene) return shapes_of(*scene, info);
  fmt::print(stderr, "note: the shapes of the objects are not known: {}\n", refuse(scene.error()).value().text);
  return Shapes();
}
#else
tl::expected<Shapes, Failure> shapes_of(const ExportFoxgloveOptions& options, const TraceInfo&) {
  if (options.scene.empty()) return Shapes();
  return refuse("--scene " + shown(options.scene) + ": this program reads no scenes", "Build it with TACTUS_WITH_SIM=ON.");
}
#endif

bool is_for_plotjuggler(const std::string& layout) { return layout.ends_with(".xml"); }

Outcome write_layout(const ExportFoxgloveOptions& options, const TraceInfo& info) {
  if (options.layout.empty()) return {};
  const bool juggles = is_for_plotjuggler(options.layout);
  return write_file(options.layout, juggles ? plotjuggler_layout(info) : foxglove_layout(info), options.common.existing());
}

Outcome write_all(MotionSource& source, FoxgloveWriter& writer, const ExportFoxgloveOptions& options, Report& report) {
  ReadProgress progress("export", source.trace(), options.common.progress());
  TraceFrame frame;
  while (true) {
    TACTUS_TRY(const bool more, source.next(frame));
    if (!more) break;
    const auto written = report.timings[0].times.measure([&] { return writer.write(frame); });
    if (!written) return refuse(options.output, location_of_tick(frame.tick), written.error());
    report.ticks.add(frame.tick);
    progress.update(report.ticks.count());
  }
  if (const auto done = writer.finish(); !done) return refuse(options.output, done.error());
  return {};
}

Outcome run_export_foxglove(const ExportFoxgloveOptions& options) {
  TACTUS_CHECK(check_no_terminal(options.output));
  TACTUS_TRY(auto source, MotionSource::open(options.input, options.common.progress()));
  TACTUS_TRY(auto shapes, shapes_of(options, source.info()));
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input, options.layout}));
  if (!options.layout.empty())
    TACTUS_CHECK(OutputFile::check_free(options.layout, options.common.existing(), {options.input, options.output}));
  auto writer = FoxgloveWriter::create(output.working_path(), source.info(), std::move(shapes), options.foxglove);
  if (!writer) return refuse(options.output, writer.error());
  Report report{.command = "export foxglove",
                .files = {{source.is_stream() ? "stream" : "trace", options.input}, {"view", options.output}}};
  report.describe(source.info());
  report.timings = {{"write"}};
  TACTUS_CHECK(write_all(source, *writer, options, report));
  TACTUS_CHECK(output.keep());
  TACTUS_CHECK(write_layout(options, source.info()));
  print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_export_foxglove(Command& group, Action& action) {
  auto options = std::make_shared<ExportFoxgloveOptions>();
  Command& command = group.add_command("foxglove", "A recording for the 3-D panel of Foxglove and Lichtblick");
  command.add_option("FILE", options->input, "Trace (MCAP), or stream, which is decoded; - is standard input")
      ->type_name("")
      ->required();
  command.add_option("-o,--output", options->output, "Recording to write (MCAP), - is standard output")
      ->required()
      ->type_name("FILE");
  command.add_option("--scene", options->scene, "Scene with the shapes of the objects [that in the trace]")
      ->type_name("NAME|FILE");
  command.add_option("--rate", options->foxglove.rate, "Frames per second of the recording, at most [60]")
      ->check(number(1e-3, 1e5))
      ->type_name("HZ");
  command.add_option("--layout", options->layout, "Layout of panels to write: FILE.json for Foxglove, FILE.xml for PlotJuggler")
      ->check([](const std::string& typed) {
        return typed.ends_with(".json") || typed.ends_with(".xml") ? "" : shown(typed) + ": give a FILE.json or a FILE.xml";
      })
      ->type_name("FILE");
  add_quantity(command, "--arrow", options->foxglove.metres_per_newton, Dimension::length, "Length of the arrow of 1 N [5cm]")
      ->check(above_zero(Dimension::length));
  add_output_options(command, options->common);
  command.footer(
      "It holds the surfaces of rigid and deformable objects (their colour is the displacement), each user's device (black), "
      "the point\n"
      "that it touches (green), the rendered force (orange) and that of the server (blue), as far as they are known, and what "
      "plots\n"
      "need of them. Import the layout in the viewer, which otherwise shows no topic of the scene at first.\n"
      "Examples:\n"
      "  tactus export foxglove membrane.mcap -o membrane-3d.mcap --layout membrane.json\n"
      "  tactus export foxglove push.tct --scene push-1dof -o push-3d.mcap");
  on_chosen<ExportFoxgloveOptions>(command, action, options, run_export_foxglove);
}

}  // namespace tactus::cli
