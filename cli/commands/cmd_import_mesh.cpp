// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include <tactus/base/shown.h>
#include <tactus/base/text.h>
#include <tactus/sim/surface/surface_sequence.h>
#include <tactus/trace/messages.h>
#include <tactus/trace/trace_file.h>
#include "cli/commands/commands.h"
#include "cli/report/report.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

struct ImportMeshOptions {
  std::string input, output, name = "mesh";
  double rate = 60;        // [Hz]
  double period = 0;       // [s], 0: that of the rate
  double length_unit = 1;  // [m]
  CommonOptions common;
};

/// When frames come: in ticks of a whole number per second.
struct Clock {
  std::uint32_t tick_rate = 0;
  double period = 1;  // [ticks]
};

/// The slowest of the usual clocks on whose ticks every frame falls; where none is found, the fastest.
Clock clock_of(const ImportMeshOptions& options) {
  const double period = options.period > 0 ? options.period : 1 / options.rate;
  if (const double rate = std::round(1 / period); rate >= 1 && std::abs(rate * period - 1) < 1e-9)
    return {static_cast<std::uint32_t>(rate), 1};
  for (const std::uint32_t rate : {1000u, 10'000u, 100'000u, kMaxTickRate}) {
    const double ticks = period * rate, whole = std::round(ticks);
    if (whole >= 1 && std::abs(ticks - whole) < 1e-6 * whole) return {rate, whole};
  }
  return {kMaxTickRate, period * kMaxTickRate};
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
    frame.tick = std::llround(static_cast<double>(k) * clock.period);
    float* out = frame.meshes[0].displacements.data();
    for (std::size_t v = 0; v < positions->size(); ++v) {
      const Vec3 u = options.length_unit * (*positions)[v] - rest.vertices[v];
      for (const double c : {u.x, u.y, u.z}) *out++ = static_cast<float>(c);
    }
    if (const auto written = writer.write(frame); !written)
      return refuse(options.output, place_of_tick(frame.tick), written.error());
    report.ticks.add(frame.tick);
    progress.update(k + 1);
  }
  return {};
}

std::string name_mistake(const std::string& name) {
  if (is_plain_name(name)) return "";
  return fmt::format("'{}': a name has 1 to 255 bytes of UTF-8 without '/' and control characters", shown(name));
}

Outcome run(const ImportMeshOptions& options) {
  TACTUS_CHECK(check_no_terminal(options.output));
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing()));
  const auto sequence = sim::SurfaceSequence::open(options.input);
  if (!sequence) return refuse(sequence.error());
  TriMesh rest = sequence->rest();
  for (Vec3& p : rest.vertices) p = options.length_unit * p;
  const Clock clock = clock_of(options);
  const TraceInfo info{.tick_rate = clock.tick_rate,
                       .objects = {},
                       .users = {},
                       .source = "import " + options.input,
                       .scene = {},
                       .meshes = {{.name = options.name, .rest = rest, .period = clock.period}}};
  auto writer = TraceWriter::create(output.working_path(), info);
  if (!writer) return refuse(options.output, writer.error());
  Report report{.command = "import mesh", .files = {{"frames", options.input}, {"trace", options.output}}};
  report.timings = {{"read", "read, per frame"}};
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
  Command& command = group.add_command("mesh", "A folder of OBJ, PLY or OFF files, one per frame of a mesh that moves");
  command.add_option("FOLDER", options->input, "Folder with the frames, in the order of the numbers in their names")
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
  command.add_option("--name", options->name, "Name of the mesh [mesh]")->check(name_mistake)->type_name("NAME");
  add_output_options(command, options->common);
  command.footer(
      "Examples:\n"
      "  tactus import mesh horse/ --rate 30 --length-unit 1mm -o horse.mcap\n"
      "  tactus import mesh shapes/ --period 17ms -o membrane.mcap");
  on_chosen<ImportMeshOptions>(command, action, options, run);
}

}  // namespace tactus::cli
