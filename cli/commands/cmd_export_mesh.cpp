// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include <tactus/base/shown.h>
#include <tactus/sim/surface/surface_file.h>
#include <tactus/trace/trace_file.h>
#include "cli/commands/commands.h"
#include "cli/report/report.h"
#include "cli/report/trace_ending.h"

namespace tactus::cli {
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

Outcome run(const ExportMeshOptions& options) {
  auto reader = open_trace(options.input);
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
  report.timings = {{"write", "write, per frame"}};
  std::uint64_t count = 0;
  while (true) {
    const auto more = reader->next(frame);
    if (!more) return refuse(options.input, more.error());
    if (!*more) break;
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
  on_chosen<ExportMeshOptions>(command, action, options, run);
}

}  // namespace tactus::cli
