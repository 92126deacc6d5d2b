// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/stiffness_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <utility>

#include <tactus/sim/deformable/stiffness_map.h>
#include <tactus/trace/csv_reader.h>
#include "cli/figure/figure.h"
#include "cli/report/json.h"

namespace tactus::cli {
namespace {

/// A surface and its stiffness; null: the vertex is fixed.
Json figure_of(const std::string& object, const sim::StiffnessMap& map) {
  Json vertices = Json::array(), stiffness = Json::array();
  for (const Vec3& at : map.surface.vertices) vertices.push_back({at.x, at.y, at.z});
  for (const double k : map.stiffness) stiffness.push_back(std::isfinite(k) ? Json(k) : Json());
  return {
      {"schema", "tactus.figure/1"},
      {"heading", "Local stiffness of " + object},
      {"surface",
       {{"vertices_m", std::move(vertices)}, {"triangles", map.surface.triangles}, {"stiffness_N_per_m", std::move(stiffness)}}}};
}

}  // namespace

Outcome write_stiffness_map(const sim::Scene& scene, const std::string& scene_file, const std::string& file,
                            OutputFile::Existing existing, const std::vector<std::string>& others) {
  TACTUS_TRY(auto table, OutputFile::create(file, existing, others));
  TACTUS_TRY(const auto out, table.open());
  *out << "deformable,vertex,x_m,y_m,z_m,stiffness_N_per_m\n";
  std::vector<std::pair<std::string, Json>> figures;  // by their files
  for (const sim::SceneDeformable& object : scene.deformables) {
    const auto map = sim::stiffness_map(object);
    if (!map) return refuse(scene_file, object.name, map.error());
    for (std::size_t v = 0; v < map->stiffness.size(); ++v) {
      const Vec3& at = map->surface.vertices[v];
      *out << fmt::format("{},{},{},{},{},{}\n", csv_field(object.name), v, at.x, at.y, at.z, map->stiffness[v]);
    }
    const std::filesystem::path base(file);
    std::string name = base.stem().string() + (figures.empty() ? "" : "-" + object.name);
    std::replace(name.begin(), name.end(), '/', '_');
    figures.emplace_back((base.parent_path() / (name + ".svg")).string(), figure_of(object.name, *map));
  }
  if (file == "-") figures.clear();
  for (const auto& [path, figure] : figures) {
    TACTUS_CHECK(OutputFile::check_free(path, existing, {file}));
    TACTUS_CHECK(OutputFile::check_free(path, existing, others));
  }
  TACTUS_CHECK(table.keep());
  if (const Outcome can = figures.empty() ? Outcome() : check_can_draw(); !can) {
    fmt::print(stderr, "note: {}: the stiffness map is a table alone ({})\n", can.error().text, can.error().remedy);
    return {};
  }
  for (const auto& [path, figure] : figures) TACTUS_CHECK(draw(path, figure, existing));
  return {};
}

}  // namespace tactus::cli
