// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/cmd_import.h"
#include "cli/report.h"
#include "cli/table.h"
#include "codec/trace/trace_file.h"
#include "sim/surface/surface_sequence.h"

namespace tactus::cli {
namespace {

struct ImportMeshOptions {
  std::string input, output, name = "mesh";
  std::uint32_t rate = 60;  // [Hz]
  double length_unit = 1;   // [m]
  CommonOptions common;
};

/// Every frame is one tick; what is kept is its distance from the first.
Outcome write_frames(const SurfaceSequence& sequence, const TriMesh& rest, const ImportMeshOptions& options, TraceWriter& writer,
                     Report& report) {
  TraceFrame frame;
  frame.meshes.resize(1);
  frame.meshes[0].updated = true;
  frame.meshes[0].displacements.resize(3 * rest.vertices.size());
  Progress progress("import", sequence.size(), options.common.progress());
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    const auto positions = report.timings[0].times.measure([&] { return sequence.positions(k); });
    if (!positions) return refuse(to_string(positions.error()), "");
    frame.tick = static_cast<std::int64_t>(k);
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

Outcome run(const ImportMeshOptions& options) {
  if (!(options.length_unit > 0)) return refuse_arguments("--length-unit: not above 0", "Give a length, such as 1mm.");
  auto output = OutputFile::create(options.output, options.common.existing());
  if (!output) return tl::unexpected(output.error());
  const auto sequence = SurfaceSequence::open(options.input);
  if (!sequence) return refuse(to_string(sequence.error()), "");
  TriMesh rest = sequence->rest();
  for (Vec3& p : rest.vertices) p = options.length_unit * p;
  const TraceInfo info{.tick_rate = options.rate,
                       .objects = {},
                       .users = {},
                       .source = "import " + options.input,
                       .scene = {},
                       .meshes = {{options.name, rest}}};
  auto writer = TraceWriter::create(output->working_path(), info);
  if (!writer) return refuse(options.output, writer.error());
  Report report{.command = "import mesh", .files = {{"frames", options.input}, {"trace", options.output}}};
  report.timings = {{"read", "read, per frame"}};
  if (auto written = write_frames(*sequence, rest, options, *writer, report); !written) return written;
  if (const auto finished = writer->finish(); !finished) return refuse(options.output, finished.error());
  report.describe(info);
  report.meshes.push_back({.name = options.name, .vertices = rest.vertices.size(), .triangles = rest.triangles.size()});
  if (auto kept = output->keep(); !kept) return kept;
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
  command.add_option("--rate", options->rate, "Frames per second [60]")->check(whole_number(1, 1000000))->type_name("HZ");
  add_quantity(command, "--length-unit", options->length_unit, Dimension::length, "Metres per unit of the files' lengths [1m]");
  command.add_option("--name", options->name, "Name of the mesh [mesh]")->type_name("NAME");
  add_output_options(command, options->common);
  command.footer("Example:\n  tactus import mesh horse/ --rate 30 --length-unit 1mm -o horse.mcap");
  on_chosen<ImportMeshOptions>(command, action, options, run);
}

}  // namespace tactus::cli
