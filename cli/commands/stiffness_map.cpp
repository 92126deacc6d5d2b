// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/stiffness_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include <tactus/sim/deformable/stiffness_map.h>
#include <tactus/sim/tets/tet_mesh.h>
#include <tactus/trace/csv_reader.h>

namespace tactus::cli {
namespace {

constexpr double kMillimetre = 1e-3;  // [m]

struct Span {
  double low, high;
};

/// A colour scale that most of the surface spans: a few vertices beside a fixed one are far stiffer than all the rest.
struct Scale {
  Span colours, all;
};
Scale scale_of(const sim::StiffnessMap& map) {
  std::vector<double> finite;
  std::copy_if(map.stiffness.begin(), map.stiffness.end(), std::back_inserter(finite), [](double k) { return std::isfinite(k); });
  if (finite.empty()) return {{1, 10}, {1, 10}};
  std::sort(finite.begin(), finite.end());
  const double low = finite.front();
  return {{low, std::max(finite[finite.size() * 98 / 100], 1.1 * low)}, {low, finite.back()}};
}

/// 1, 2 and 5 times the powers of ten in between, for gnuplot: automatic marks of a logarithmic scale stand at powers of ten only.
std::string marks(const Span& span) {
  std::string list;
  const int first = static_cast<int>(std::floor(std::log10(span.low))),
            last = static_cast<int>(std::floor(std::log10(span.high)));
  for (int exponent = first; exponent <= last; ++exponent)
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double mark = digit * std::pow(10, exponent);
      if (mark >= span.low && mark <= span.high) list += fmt::format("{}{:g}", list.empty() ? "" : ", ", mark);
    }
  return list;
}

Plot stiffness_plot(const std::string& file, const std::string& object, const sim::StiffnessMap& map) {
  const Scale scale = scale_of(map);
  Plot plot{.name = file, .program = "stiffness-map", .width = 1000, .height = 640};
  PlotData faces{"faces", {}}, held{"held", {}};
  const auto row = [&](std::uint32_t v) -> std::vector<double> {
    const Vec3& p = map.surface.vertices[v];
    return {p.x / kMillimetre, p.y / kMillimetre, p.z / kMillimetre, std::min(map.stiffness[v], scale.colours.high)};
  };
  // gnuplot draws patches of four corners: of a triangle the last one stands twice.
  for (const auto& [a, b, c] : map.surface.triangles)
    for (const auto& line : {row(a), row(b), {}, row(c), row(c), {}, {}}) faces.rows.push_back(line);
  for (std::uint32_t v = 0; v < map.stiffness.size(); ++v)
    if (!std::isfinite(map.stiffness[v])) held.rows.push_back(row(v));
  const auto [low, high] = sim::bounds(map.surface.vertices);
  const double flatness = 1 - (high.z - low.z) / std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  plot.set("heading", fmt::format("Local stiffness of {}: {:.3g} to {:.3g} N/m", object, scale.all.low, scale.all.high));
  plot.set("low", scale.colours.low);
  plot.set("high", scale.colours.high);
  plot.set("marks", marks(scale.colours));
  plot.set("bottom", low.z / kMillimetre);
  plot.set("top", high.z / kMillimetre);
  plot.set("zoom", 1 + 0.5 * flatness);
  plot.set("fixed", static_cast<double>(held.rows.size()));
  plot.data = {std::move(faces), std::move(held)};
  return plot;
}

}  // namespace

tl::expected<Drawn, Failure> write_stiffness_map(const sim::Scene& scene, const std::string& scene_file, const std::string& file,
                                                 OutputFile::Existing existing, std::initializer_list<std::string> others) {
  TACTUS_TRY(auto table, OutputFile::create(file, existing, others));
  TACTUS_TRY(const auto out, table.open());
  *out << "deformable,vertex,x_m,y_m,z_m,stiffness_N_per_m\n";
  const std::filesystem::path place(file);
  std::vector<Plot> plots;
  for (const sim::SceneDeformable& object : scene.deformables) {
    const auto map = sim::stiffness_map(object);
    if (!map) return refuse(scene_file, object.name, map.error());
    for (std::size_t v = 0; v < map->stiffness.size(); ++v) {
      const Vec3& at = map->surface.vertices[v];
      *out << fmt::format("{},{},{},{},{},{}\n", csv_field(object.name), v, at.x, at.y, at.z, map->stiffness[v]);
    }
    const std::string stem = place.stem().string();
    std::string name = plots.empty() ? stem : stem + "-" + object.name;
    std::replace(name.begin(), name.end(), '/', '_');
    plots.push_back(stiffness_plot(name, object.name, *map));
  }
  const std::string folder = place.has_parent_path() ? place.parent_path().string() : ".";
  if (file == "-") plots.clear();
  for (const Plot& plot : plots) {
    TACTUS_CHECK(check_plot(plot, folder, existing, {file}));
    TACTUS_CHECK(check_plot(plot, folder, existing, others));
  }
  TACTUS_CHECK(table.keep());
  for (const Plot& plot : plots) {
    auto drawn = draw(plot, folder, existing);
    if (!drawn || *drawn == Drawn::no) return drawn;
  }
  return Drawn::yes;
}

}  // namespace tactus::cli
