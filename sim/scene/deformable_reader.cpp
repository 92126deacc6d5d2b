// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/scene/deformable_reader.h>

#include <algorithm>
#include <cmath>

#include <tactus/sim/tets/tet_files.h>

namespace tactus::sim {
namespace {

constexpr double kFarthest = 500, kLargest = 100;  // [m] as for other objects
constexpr Range kPosition{-kFarthest, kFarthest};
constexpr double kTetBytes = 3000;            // as measured, without a factorised matrix
constexpr std::uint64_t kMostTets = 170'000;  // of a scene
constexpr double kRounding = 1e-9;            // of the mesh's size: tolerance of boxes and corners

// As tactus::sim::name(Method) and name(LinearSolver) spell them; modal is left out, because contact excites what its modes lack.
constexpr std::array<std::string_view, 6> kMethods{"auto",    "velocity-verlet", "backward-euler",
                                                   "newmark", "tr-bdf2",         "projective"};
constexpr std::array<std::string_view, 4> kSolvers{"auto", "cg", "cholesky", "prefactored"};

struct Box {
  Vec3 low, high;
  bool holds(const Vec3& p) const {
    return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
  }
};

Box bounds(const TetMesh& mesh) {
  if (mesh.vertices.empty()) return {};
  Box box{mesh.vertices[0], mesh.vertices[0]};
  for (const Vec3& v : mesh.vertices) {
    box.low = {std::min(box.low.x, v.x), std::min(box.low.y, v.y), std::min(box.low.z, v.z)};
    box.high = {std::max(box.high.x, v.x), std::max(box.high.y, v.y), std::max(box.high.z, v.z)};
  }
  return box;
}

/// The box of a table, a little larger than written.
Box read_box(TomlReader& in, const toml::table& table, const std::string& path, double margin) {
  const Box box{in.vector(table, path, "low", kPosition), in.vector(table, path, "high", kPosition)};
  const Vec3 grown{margin, margin, margin};
  return {box.low - grown, box.high + grown};
}

std::string in_megabytes(double bytes) { return std::to_string(std::llround(bytes / 1e6)) + " MB"; }

TetMesh read_slab(TomlReader& in, const toml::table& table, const std::string& path) {
  const toml::node& node = *table.get("cells");
  const double cell = in.number(table, path, "cell", {1e-5, kLargest});
  const toml::array* cells = node.as_array();
  if (!cells || cells->size() != 3) {
    in.fail_at(node.source(), Errc::invalid, "R-SCN-5", path + ".cells", "write an array of 3 whole numbers");
    return {};
  }
  std::array<std::uint32_t, 3> n{};
  for (std::size_t i = 0; i < 3; ++i) n[i] = in.checked_whole((*cells)[i], path + ".cells", {1, 1000});
  if (in.failed() || !affords_tets(in, node, path + ".cells", 6 * std::uint64_t{n[0]} * n[1] * n[2])) return {};
  return make_slab(n[0], n[1], n[2], cell);
}

TetMesh read_file(TomlReader& in, const toml::table& table, const std::string& path, const std::filesystem::path& folder) {
  const auto refuse = [&](const std::string& why) {
    in.fail_at(table.get("mesh")->source(), Errc::invalid, "R-SCN-8", path + ".mesh", why);
    return TetMesh{};
  };
  const std::string file = (folder / in.text(table, path, "mesh")).string();
  if (in.failed()) return {};
  if (is_special_file(file)) return refuse(file + ": name a regular file");
  auto read = read_tet_mesh(file);
  if (!read) return refuse(to_string(read.error()));
  if (const auto sound = check(read->mesh); !sound) return refuse(file + ": " + to_string(sound.error()));
  return std::move(read->mesh);
}

TetMesh read_mesh(TomlReader& in, const toml::table& table, const std::string& path, const std::filesystem::path& folder) {
  if (table.contains("cells") != table.contains("mesh"))
    return table.contains("cells") ? read_slab(in, table, path) : read_file(in, table, path, folder);
  in.fail_at(table.source(), Errc::invalid, "R-SCN-4", path + ".cells",
             "say what it is made of: either cells and cell (a slab), or mesh (a .node, .ele or .msh file)");
  return {};
}

/// "corners": the vertices in the corners of the mesh's box.
void fix_corners(TomlReader& in, const toml::node& node, SceneDeformable& body) {
  const Box box = bounds(body.mesh);
  const Vec3 size = box.high - box.low;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Vec3 at = box.low + Vec3{corner & 1 ? size.x : 0, corner & 2 ? size.y : 0, corner & 4 ? size.z : 0};
    const auto found = std::find_if(body.mesh.vertices.begin(), body.mesh.vertices.end(),
                                    [&](const Vec3& v) { return norm(v - at) <= kRounding * norm(size); });
    if (found == body.mesh.vertices.end())
      in.fail_at(node.source(), Errc::invalid, "R-SCN-6", "deformable.fixed",
                 "this mesh has no vertex in a corner of its box; fix boxes [[deformable.fixed]] with low and high");
    else body.fixed.push_back(static_cast<std::uint32_t>(found - body.mesh.vertices.begin()));
  }
  std::sort(body.fixed.begin(), body.fixed.end());
}

void fix_box(TomlReader& in, const toml::table& table, double margin, SceneDeformable& body) {
  const std::string path = "deformable.fixed";
  in.allow(table, path, {"low", "high"});
  const Box box = read_box(in, table, path, margin);
  const std::size_t before = body.fixed.size();
  for (std::uint32_t v = 0; v < body.mesh.vertices.size(); ++v)
    if (box.holds(body.mesh.vertices[v])) body.fixed.push_back(v);
  if (body.fixed.size() == before)
    in.fail_at(table.source(), Errc::invalid, "R-SCN-6", path, "no vertex lies in this box; its numbers are those of the mesh");
}

void read_fixed(TomlReader& in, const toml::table& table, double margin, SceneDeformable& body) {
  const toml::node* node = table.get("fixed");
  if (!node) return;
  if (node->is_string()) {
    in.word(table, "deformable", "fixed", {"corners"}, "corners");
    return fix_corners(in, *node, body);
  }
  for (const toml::table* box : in.tables(table, "deformable", "fixed")) fix_box(in, *box, margin, body);
  std::sort(body.fixed.begin(), body.fixed.end());
  body.fixed.erase(std::unique(body.fixed.begin(), body.fixed.end()), body.fixed.end());
}

SceneMaterial read_material(TomlReader& in, const toml::table& table, const std::string& path,
                            const std::optional<SceneMaterial>& usual) {
  const auto fallback = [&](double SceneMaterial::*part) { return usual ? std::optional((*usual).*part) : std::nullopt; };
  return {.young = in.number(table, path, "young", {1e-3, 1e15}, fallback(&SceneMaterial::young)),
          .poisson = in.number(table, path, "poisson", {-0.999, 0.4999}, fallback(&SceneMaterial::poisson)),
          .density = in.number(table, path, "density", {1e-3, 1e6}, fallback(&SceneMaterial::density))};
}

/// Tetrahedra whose centroid lies in the region's box, or beyond its plane, are made of its material.
void read_region(TomlReader& in, const toml::table& table, double margin, SceneDeformable& body) {
  const std::string path = "deformable.region";
  in.allow(table, path, {"young", "poisson", "density", "low", "high", "point", "normal"});
  const SceneMaterial material = read_material(in, table, path, body.materials.front());
  const bool is_box = table.contains("low") || table.contains("high");
  const Box box = is_box ? read_box(in, table, path, margin) : Box{};
  const Vec3 point = is_box ? Vec3{} : in.vector(table, path, "point", kPosition);
  const Vec3 normal = is_box ? Vec3{} : in.vector(table, path, "normal", {-1, 1});
  body.materials.resize(body.mesh.tets.size(), body.materials.front());
  bool any = false;
  for (std::size_t t = 0; t < body.mesh.tets.size(); ++t) {
    const auto& [a, b, c, d] = body.mesh.tets[t];
    const auto& v = body.mesh.vertices;
    const Vec3 centroid = 0.25 * (v[a] + v[b] + v[c] + v[d]);
    if (is_box ? !box.holds(centroid) : dot(centroid - point, normal) < 0) continue;
    body.materials[t] = material;
    any = true;
  }
  if (!any) in.fail_at(table.source(), Errc::invalid, "R-SCN-6", path, "no tetrahedron's centre lies in this region");
}

}  // namespace

bool affords_tets(TomlReader& in, const toml::node& node, const std::string& key, std::uint64_t tets) {
  if (tets <= kMostTets) return true;
  in.fail_at(node.source(), Errc::invalid, "R-SCN-6", key,
             std::to_string(tets) + " tetrahedra would take about " + in_megabytes(kTetBytes * static_cast<double>(tets)) +
                 " of memory; stay below " + in_megabytes(kTetBytes * kMostTets) + ", which are " + std::to_string(kMostTets) +
                 " tetrahedra in all, six for a cell");
  return false;
}

SceneDeformable read_deformable(TomlReader& in, const toml::table& table, const std::filesystem::path& folder,
                                const SceneTouch& touch) {
  const std::string path = "deformable";
  in.allow(table, path,
           {"name", "mesh", "cells", "cell", "position", "young", "poisson", "density", "region", "fixed", "elasticity",
            "mass_damping", "stiffness_damping", "stiffness", "friction", "method", "solver", "rate"});
  SceneDeformable body;
  body.name = in.name(table, path);
  body.mesh = read_mesh(in, table, path, folder);
  body.materials = {read_material(in, table, path, std::nullopt)};
  body.corotated = in.word(table, path, "elasticity", {"corotated", "linear"}, "corotated") == 0;
  body.mass_damping = in.number(table, path, "mass_damping", {0, 1e6}, 0.0);
  body.stiffness_damping = in.number(table, path, "stiffness_damping", {0, 1e3}, 0.0);
  body.stiffness = in.number(table, path, "stiffness", {1e-3, 1e5}, touch.stiffness);
  body.friction = in.number(table, path, "friction", {0, 100}, touch.friction);
  body.rate = in.whole(table, path, "rate", {1, 1000}, 1);
  body.method = kMethods.at(in.word(table, path, "method", kMethods, "auto"));
  body.solver = kSolvers.at(in.word(table, path, "solver", kSolvers, "auto"));
  const Vec3 position = in.vector(table, path, "position", kPosition);
  if (in.failed()) return body;

  const Box box = bounds(body.mesh);
  const double margin = kRounding * norm(box.high - box.low);
  for (const toml::table* region : in.tables(table, path, "region")) read_region(in, *region, margin, body);
  read_fixed(in, table, margin, body);
  for (Vec3& vertex : body.mesh.vertices) vertex = vertex + position;
  return body;
}

}  // namespace tactus::sim
