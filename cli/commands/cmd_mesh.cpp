// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <sys/resource.h>

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <set>
#include <string_view>

#include <tactus/base/shown.h>
#include <tactus/sim/tets/tet_files.h>
#include <tactus/sim/tets/tet_mesh.h>
#include "cli/options/option_needs.h"
#include "cli/report/json.h"
#include "cli/report/notes.h"
#include "cli/report/report.h"
#ifdef TACTUS_HAS_SURFACE
#include <tactus/sim/surface/surface_file.h>
#include <tactus/sim/surface/tetgen.h>
#endif

namespace tactus::cli {
namespace {

struct MeshOptions {
  std::string input, slab, output, node, axes;
  double cell = 0.01;      // [m]
  double length_unit = 1;  // [m]
  double edge = 0;         // [m], 0: as large as may be
  double quality = 0;      // 0: any
  double time_limit = 60;  // [s]
  bool split_surface = false, drop_degenerate = false;
  CommonOptions common;
};

/// [ns] Of the processes that have ended: the one that fills surfaces is none of ours.
std::int64_t cpu_of_children() {
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  const auto ns = [](const timeval& time) {
    return std::int64_t{1'000} * (std::int64_t{1'000'000} * time.tv_sec + time.tv_usec);
  };
  return ns(used.ru_utime) + ns(used.ru_stime);
}

/// What became of the input, and how long each part took.
struct TetMeshReport {
  sim::TetMesh mesh;
  std::vector<std::pair<std::string, std::uint64_t>> notes;  // field of the report, number
  std::vector<std::string> warnings;                         // what a reader decided about the file
  std::vector<std::pair<std::string, StepTimes>> times;

  template <class Work>
  auto measure(const std::string& step, Work&& work) {
    const std::int64_t children = cpu_of_children();
    const Stopwatch watch;
    auto result = std::forward<Work>(work)();
    Cost cost = watch.elapsed();
    cost.cpu_ns += cpu_of_children() - children;
    times.emplace_back(step, StepTimes{}).second.add(cost);
    return result;
  }
};

bool is_tet_file(const std::string& path) { return path.ends_with(".msh") || path.ends_with(".node") || path.ends_with(".ele"); }

void scale(std::vector<Vec3>& points, double unit) {
  for (Vec3& p : points) p = unit * p;
}

Outcome mesh_slab(const MeshOptions& options, TetMeshReport& report) {
  std::array<std::uint32_t, 3> cells{};
  const char *at = options.slab.data(), *const end = at + options.slab.size();
  bool good = true;
  for (std::size_t i = 0; i < cells.size() && good; ++i) {
    const auto parsed = std::from_chars(at, end, cells[i]);
    at = parsed.ptr;
    good = parsed.ec == std::errc() && cells[i] >= 1 && (i == 2 ? at == end : at != end && *at++ == 'x');
  }
  if (!good) return refuse_arguments("--slab " + options.slab + ": not three numbers of cells", "Write it like 16x20x1.");
  const auto [x, y, z] = cells;
  const double vertices = (x + 1.0) * (y + 1.0) * (z + 1.0), tets = 6.0 * x * y * z;
  if (vertices > static_cast<double>(kMaxMeshVertices) || tets > static_cast<double>(sim::kMaxTets))
    return refuse_arguments("--slab " + options.slab + ": more than 2^20 vertices or 2^22 tetrahedra",
                            "Take fewer and larger cells.");
  report.mesh = report.measure("make", [&] { return tactus::sim::make_slab(cells[0], cells[1], cells[2], options.cell); });
  return {};
}

Outcome read_tets(const MeshOptions& options, TetMeshReport& report) {
  note_idle_options(*options.common.command, {}, "file");
  auto file = report.measure("read", [&] { return sim::read_tet_mesh(options.input); });
  if (!file) return refuse(file.error());
  if (file->ignored_elements > 0) report.notes.emplace_back("ignored_elements", file->ignored_elements);
  if (file->ignored_vertices > 0) report.notes.emplace_back("unused_vertices", file->ignored_vertices);
  report.mesh = std::move(file->mesh);
  scale(report.mesh.vertices, options.length_unit);
  return {};
}

#ifdef TACTUS_HAS_SURFACE
sim::Axes axes_of(const std::string& text) {
  return text == "y-up" ? sim::Axes::y_up : text == "z-up" ? sim::Axes::z_up : sim::Axes::as_the_format_says;
}

/// Volume of a regular tetrahedron.
double volume_of_edge(double edge) { return edge * edge * edge / (6 * std::numbers::sqrt2); }

Outcome fill_surface(const MeshOptions& options, TetMeshReport& report) {
  const bool is_gltf = options.input.ends_with(".glb") || options.input.ends_with(".gltf");
  note_idle_options(*options.common.command, is_gltf ? std::set{Subject::surface, Subject::gltf} : std::set{Subject::surface},
                    "file");
  const sim::SurfaceOptions how{.drop_degenerate = options.drop_degenerate, .axes = axes_of(options.axes), .node = options.node};
  auto file = report.measure("read", [&] { return sim::read_surface(options.input, how); });
  if (!file) return refuse(file.error());
  Report reader_notes;
  report_notes(file->notes.all(), options.input, reader_notes);
  report.warnings = std::move(reader_notes.notes);
  if (file->dropped_faces > 0) report.notes.emplace_back("dropped_faces", file->dropped_faces);
  if (file->polygons > 0) report.notes.emplace_back("cut_polygons", file->polygons);
  if (file->unused_vertices > 0) report.notes.emplace_back("unused_vertices", file->unused_vertices);
  scale(file->mesh.vertices, options.length_unit);
  const sim::FillOptions settings{.boundary = options.split_surface ? sim::Boundary::split : sim::Boundary::keep,
                                  .max_volume = volume_of_edge(options.edge),
                                  .quality = options.quality,
                                  .time_limit = options.time_limit};
  auto filled = report.measure("fill", [&] { return fill(file->mesh, settings); });
  if (!filled) {
    Diagnostic error = filled.error();
    const bool is_split = file->vertex.size() > std::set(file->vertex.begin(), file->vertex.end()).size();
    if (is_split && error.error.rule == std::string_view("R-TGN-8"))
      error.remedy =
          "Parts of the surface touch at a point, and tetrahedra cannot: move them apart there, or give each part a file of its "
          "own.";
    error.file = options.input;
    return refuse(error);
  }
  report.mesh = std::move(*filled);
  return {};
}
#else
Outcome fill_surface(const MeshOptions& options, TetMeshReport&) {
  return refuse(shown_path(options.input) + ": this program was built without reading surfaces",
                "Install nlohmann-json3-dev and build again, or give .node, .ele or .msh.");
}
#endif

tl::expected<OutputFile, Failure> open_output(const std::string& path, const MeshOptions& options, const std::string& beside,
                                              void (*write)(std::ostream&, const sim::TetMesh&), const sim::TetMesh& mesh) {
  TACTUS_TRY(auto file, OutputFile::create(path, options.common.existing(), {options.input, beside}));
  TACTUS_TRY(const auto out, file.open());
  write(*out, mesh);
  return file;
}

/// Both files of a pair are complete before either takes its name.
Outcome write_mesh(const MeshOptions& options, const sim::TetMesh& mesh) {
  if (options.output.ends_with(".msh")) {
    auto file = open_output(options.output, options, "", sim::write_msh, mesh);
    return file ? file->keep() : tl::unexpected(file.error());
  }
  const std::string ele = options.output.substr(0, options.output.size() - 5) + ".ele";
  TACTUS_TRY(auto node_file, open_output(options.output, options, ele, sim::write_node, mesh));
  TACTUS_TRY(auto ele_file, open_output(ele, options, options.output, sim::write_ele, mesh));
  TACTUS_CHECK(node_file.keep());
  return ele_file.keep();
}

Value mesh_value(const MeshOptions& options, const TetMeshReport& report) {
  const sim::TetQuality q = quality(report.mesh);
  const sim::TetSurface outside = surface(report.mesh);
  const sim::Bounds box = sim::bounds(report.mesh.vertices);
  double sum = 0;
  for (std::size_t t = 0; t < report.mesh.tets.size(); ++t) sum += volume(report.mesh, t);
  Json out{{"schema", "tactus.mesh/2"}, {"files", {{"output", options.output}}}};
  if (options.slab.empty()) out["files"]["input"] = options.input;
  else out["slab"] = options.slab;
  for (const auto& [key, number] : report.notes) out[key] = number;
  if (!report.warnings.empty()) out["warnings"] = report.warnings;
  out["vertices"] = report.mesh.vertices.size();
  out["tetrahedra"] = report.mesh.tets.size();
  out["surface_vertices"] = outside.mesh.vertices.size();
  out["surface_triangles"] = outside.mesh.triangles.size();
  out["volume_m3"] = sum;
  out["box_m"] = {{box.low.x, box.low.y, box.low.z}, {box.high.x, box.high.y, box.high.z}};
  out["smallest_angle_rad"] = {{"value", q.smallest_angle.value}, {"tetrahedron", q.smallest_angle.tet}};
  out["largest_angle_rad"] = {{"value", q.largest_angle.value}, {"tetrahedron", q.largest_angle.tet}};
  out["shape"] = {{"worst", q.shape.value}, {"tetrahedron", q.shape.tet}, {"mean", q.mean_shape}};
  for (const auto& [step, time] : report.times) out["time"][step] = time_value(time, 0);
  return out;
}

Outcome run_mesh(const MeshOptions& options) {
  if (!options.output.ends_with(".node") && !options.output.ends_with(".msh"))
    return refuse_arguments(options.output + ": not the name of a mesh",
                            "Give -o NAME.node (with NAME.ele beside it) or -o NAME.msh.");
  TetMeshReport report;
  TACTUS_CHECK(!options.slab.empty()        ? mesh_slab(options, report)
               : is_tet_file(options.input) ? read_tets(options, report)
                                            : fill_surface(options, report));
  if (auto checked = report.measure("check", [&] { return check(report.mesh); }); !checked) {
    checked.error().file = options.slab.empty() ? options.input : options.slab;
    return refuse(checked.error());
  }
  TACTUS_CHECK(report.measure("write", [&] { return write_mesh(options, report.mesh); }));
  print(mesh_value(options, report), "mesh", options.common);
  return {};
}

}  // namespace

void add_scene_options(Command& command, std::string& node, std::string& axes) {
  command.add_option("--node", node, "Of a glTF scene, take what hangs on the node of this name [all]")->type_name("NAME");
  command.add_option("--axes", axes, "What is up in the file: y-up, which is turned, or z-up [glTF: y-up, others: z-up]")
      ->one_of({"y-up", "z-up"})
      ->type_name("");
}

void setup_mesh(Command& app, Action& action) {
  auto options = std::make_shared<MeshOptions>();
  Command& command = app.add_command("mesh", "Fill a surface with tetrahedra, or make a slab of them");
  Option* input =
      command
          .add_option("FILE", options->input, "Surface (.obj, .ply, .stl, .off, .gltf, .glb) or tetrahedra (.node, .ele, .msh)")
          ->type_name("");
  Option* slab = command.add_option("--slab", options->slab, "Cells along x, y, z, six tetrahedra each, such as 16x20x1")
                     ->type_name("NxNxN");
  slab->excludes(input);
  command.add_option("-o,--output", options->output, "Mesh to write: NAME.node with NAME.ele beside it, or NAME.msh (Gmsh)")
      ->required()
      ->type_name("FILE");
  add_quantity(command, "--cell", options->cell, Dimension::length, "Edge of the slab's cells [10mm]")
      ->check(within(Dimension::length, "1um", "1000000m"))
      ->needs(slab);
  add_quantity(command, "--length-unit", options->length_unit, Dimension::length, "Metres per unit of the file's lengths [1m]")
      ->check(within(Dimension::length, "1um", "1000000m"))
      ->excludes(slab);
  add_quantity(command, "--edge", options->edge, Dimension::length, "Tetrahedra at most as large as a regular one with this edge")
      ->check(above_zero(Dimension::length))
      ->excludes(slab);
  command.add_option("--quality", options->quality, "Largest circumsphere radius by shortest edge, 1.1 or more")
      ->check(number(1.1, 100))
      ->excludes(slab)
      ->type_name("RATIO");
  command
      .add_flag("--split-surface", options->split_surface,
                "Add points on the surface too, so that --edge and --quality hold there")
      ->excludes(slab);
  add_scene_options(command, options->node, options->axes);
  command.add_flag("--drop-degenerate", options->drop_degenerate, "Leave out faces of a surface that have no area")
      ->excludes(slab);
  add_quantity(command, "--time-limit", options->time_limit, Dimension::time, "Give up after this long [60s]")
      ->check(above_zero(Dimension::time))
      ->excludes(slab);
  add_output_options(command, options->common);
  command.footer(
      "Examples:\n"
      "  tactus mesh bunny.stl --length-unit 1mm --edge 5mm --quality 1.4 -o bunny.node\n"
      "  tactus mesh --slab 16x20x1 --cell 10mm -o membrane.msh");
  command.on_chosen([&action, options, input, slab] {
    if (input->count() + slab->count() == 0) miss_option("FILE or --slab");
    action = [options] { return run_mesh(*options); };
  });
}

}  // namespace tactus::cli
