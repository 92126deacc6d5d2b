// SPDX-License-Identifier: Apache-2.0
#include "lab/study/precision_space.h"

#include <algorithm>
#include <cmath>

#include <tactus/base/rule.h>
#include <tactus/sim/fem/cholesky.h>
#include "lab/study/precision.h"
#include "lab/study/quadratic_tets.h"

namespace tactus::sim::study {
namespace {

constexpr double kNear = 1e-9;  // [m] coordinates of grid vertices carry rounding only

/// The load spread evenly over the surface triangles whose corners all lie in the region: the consistent load of constant pressure.
template <class Region>
Patch pressure_patch(const TetMesh& mesh, Region&& inside) {
  const TetSurface skin = surface(mesh);
  std::vector<double> lumped(mesh.vertices.size(), 0);
  double area = 0;
  for (const Triangle& t : skin.mesh.triangles) {
    const Vec3 &a = skin.mesh.vertices[t[0]], &b = skin.mesh.vertices[t[1]], &c = skin.mesh.vertices[t[2]];
    if (!inside(a) || !inside(b) || !inside(c)) continue;
    const double third = norm(cross(b - a, c - a)) / 6;
    for (const std::uint32_t v : t) lumped[skin.vertex[v]] += third;
    area += 3 * third;
  }
  Patch patch;
  for (std::uint32_t v = 0; v < lumped.size(); ++v) {
    if (lumped[v] == 0) continue;
    patch.vertices.push_back(v);
    patch.weights.push_back(lumped[v] / area);
  }
  return patch;
}

template <class Region>
std::vector<std::uint32_t> vertices_in(const TetMesh& mesh, Region&& inside) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
    if (inside(mesh.vertices[v])) out.push_back(v);
  return out;
}

PrecisionScene membrane(std::uint32_t r, double poisson) {
  constexpr double kCell = 0.01, kWidth = 0.16, kLength = 0.2;
  PrecisionScene scene;
  scene.mesh = make_slab(16 * r, 20 * r, r, kCell / r);
  scene.material = {.young = 1e4, .poisson = poisson, .density = 10'000};
  const auto at_an_end = [](double x, double length) { return std::min(x, length - x) < kCell + kNear; };
  scene.fixed = vertices_in(scene.mesh, [&](const Vec3& p) { return at_an_end(p.x, kWidth) && at_an_end(p.y, kLength); });
  scene.patch = pressure_patch(scene.mesh, [&](const Vec3& p) {
    return p.z > kCell - kNear && std::abs(p.x - kWidth / 2) < 2 * kCell + kNear &&
           std::abs(p.y - kLength / 2) < 2 * kCell + kNear;
  });
  return scene;
}

PrecisionScene cantilever(std::uint32_t r, double poisson) {
  PrecisionScene scene;
  scene.mesh = make_slab(5 * r, r, r, 0.2 / r);
  scene.material = {.young = 1e6, .poisson = poisson, .density = 1000};
  scene.fixed = vertices_in(scene.mesh, [](const Vec3& p) { return p.x < kNear; });
  scene.patch = pressure_patch(scene.mesh, [](const Vec3& p) { return p.x > 1 - kNear; });
  scene.load = 40;
  return scene;
}

tl::expected<FemModel, Diagnostic> make_model(const PrecisionScene& scene) {
  FemOptions options;
  options.materials = {scene.material};
  options.fixed = scene.fixed;
  return FemModel::create(scene.mesh, std::move(options));
}

}  // namespace

std::optional<PrecisionScene> space_scene(std::string_view name, int refinement, double poisson) {
  std::optional<PrecisionScene> scene;
  const auto r = static_cast<std::uint32_t>(refinement);
  if (name == "membrane") scene = membrane(r, poisson);
  if (name == "cantilever") scene = cantilever(r, poisson);
  if (scene) scene->name = name;
  return scene;
}

double timoshenko_deflection(double length, double width, double height, const Material& material) {
  const double shear = material.young / (2 * (1 + material.poisson));
  const double moment = width * height * height * height / 12;
  return length * length * length / (3 * material.young * moment) + length / (5.0 / 6 * shear * width * height);
}

tl::expected<StaticResult, Diagnostic> static_deflection(const PrecisionScene& scene) {
  const double begin = processor_seconds();
  TACTUS_TRY(auto model, make_model(scene));
  SparseMatrix stiffness;
  model.stiffness(Eigen::VectorXd::Zero(model.size()), stiffness);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(model.size()), u = f;
  scene.patch.add_force(1, f);

  const auto free = model.free_dofs();
  Eigen::VectorXd right(static_cast<Eigen::Index>(free.size()));
  for (std::size_t i = 0; i < free.size(); ++i) right[static_cast<Eigen::Index>(i)] = f[free[i]];
  Cholesky cholesky;
  cholesky.analyse(stiffness);
  if (!cholesky.factor(stiffness))
    return tl::unexpected(Diagnostic{.error = fail(Errc::internal, "R-FEM-7").value(), .remedy = "Fix more vertices."});
  Eigen::VectorXd solution(right.size());
  cholesky.solve(right, solution);
  for (std::size_t i = 0; i < free.size(); ++i) u[free[i]] = solution[static_cast<Eigen::Index>(i)];
  return StaticResult{scene.patch.deflection(u), processor_seconds() - begin};
}

std::vector<SpaceJob> space_jobs(std::string_view name, Extent extent) {
  const bool full = extent == Extent::full, is_membrane = name == "membrane";
  if (!full && is_membrane) return {};  // its finer meshes take minutes
  std::vector<double> ratios{is_membrane ? 0.45 : 0.3};
  std::vector<int> refinements{1, 2, 4};
  if (full && is_membrane) refinements = {1, 2, 3, 4};
  if (full && !is_membrane) {
    ratios = {0.3, 0.45, 0.49, 0.499};
    refinements = {1, 2, 4, 8};
  }
  std::vector<SpaceJob> jobs;
  for (const double poisson : ratios)
    for (const int r : refinements) jobs.push_back({r, poisson, full && poisson == ratios.front(), r == 1 || r == 2 || r == 4});
  return jobs;
}

tl::expected<SpacePoint, Diagnostic> measure_space(std::string_view name, const SpaceJob& job) {
  const PrecisionScene scene = *space_scene(name, job.refinement, job.poisson);
  SpacePoint out;
  out.refinement = job.refinement;
  out.poisson = job.poisson;
  out.vertices = scene.mesh.vertices.size();
  out.tets = scene.mesh.tets.size();
  TACTUS_TRY(const auto at_rest, static_deflection(scene));
  out.at_rest = at_rest;
  if (job.quadratic) {
    TACTUS_TRY(const auto quadratic, quadratic_static_deflection(scene));
    out.quadratic_deflection = quadratic;
  }
  if (!job.transient) return out;

  TACTUS_TRY(const auto model, make_model(scene));
  const int steps = static_cast<int>(std::ceil(scene.duration / scene.samples * model.largest_frequency()));
  TACTUS_TRY(const auto run, simulate(scene, {"velocity Verlet", {.method = Method::velocity_verlet}}, steps, Loading::force));
  out.step = scene.step(steps);
  out.seconds_per_second = run.step_seconds / scene.duration;
  for (const Eigen::VectorXd& u : run.u) out.deflection.push_back(scene.patch.deflection(u));
  return out;
}

}  // namespace tactus::sim::study
