// SPDX-License-Identifier: Apache-2.0
#include "lab/study/precision_scene.h"

#include <cmath>

namespace tactus::sim::study {
namespace {

constexpr std::uint32_t kAcross = 16, kAlong = 20;  // cells of the membrane

Patch even_patch(std::vector<std::uint32_t> vertices) {
  const double weight = 1 / static_cast<double>(vertices.size());
  std::vector<double> weights(vertices.size(), weight);
  return {std::move(vertices), std::move(weights)};
}

template <class Predicate>
std::vector<std::uint32_t> vertices_where(const TetMesh& mesh, Predicate&& predicate) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
    if (predicate(mesh.vertices[v])) out.push_back(v);
  return out;
}

/// The slab of `across` x `along` x 1 cells, its corners fixed, loaded at the middle of its top.
PrecisionScene slab(std::uint32_t across, std::uint32_t along, double young) {
  PrecisionScene scene;
  const double cell = 0.16 / across;
  scene.mesh = make_slab(across, along, 1, cell);
  scene.material = {.young = young, .poisson = 0.45, .density = 10'000};
  const std::uint32_t row = across + 1, layer = row * (along + 1);
  for (const std::uint32_t corner : {0u, across, layer - row, layer - 1}) {
    scene.fixed.push_back(corner);
    scene.fixed.push_back(corner + layer);
  }
  scene.patch = even_patch({layer + along / 2 * row + across / 2});
  return scene;
}

PrecisionScene membrane(Extent extent) {
  const bool full = extent == Extent::full;
  PrecisionScene scene = full ? slab(kAcross, kAlong, 1e4) : slab(kAcross / 2, kAlong / 2, 1e4);
  scene.title = "membrane: E 10 kPa, load -sin^2(2 pi t) N at the centre";
  scene.probe = {.stiffness = 700, .depth = 0.02};
  scene.steps_per_sample = {6, 12, 25, 30, 50, 100, 200, 400};
  scene.reference_steps_per_sample = 2000;
  return scene;
}

PrecisionScene membrane_stiff(Extent extent) {
  const bool full = extent == Extent::full;
  PrecisionScene scene = full ? slab(kAcross, kAlong, 1e7) : slab(kAcross / 2, kAlong / 2, 1e7);
  scene.title = "stiff membrane: E 10 MPa, load -sin^2(2 pi t) N at the centre";
  scene.probe = {.stiffness = 700, .depth = 0.002};
  scene.steps_per_sample = {6, 12, 25, 50, 100, 200, 400, 1000};
  scene.reference_steps_per_sample = 8000;
  return scene;
}

PrecisionScene cantilever(Extent extent) {
  const std::uint32_t cells = extent == Extent::full ? 4 : 2;
  const double cell = 0.2 / cells;
  PrecisionScene scene;
  scene.mesh = make_slab(5 * cells, cells, cells, cell);
  scene.title = "cantilever: E 1 MPa, load -40 sin^2(2 pi t) N on the tip";
  scene.material = {.young = 1e6, .poisson = 0.3, .density = 1000};
  scene.fixed = vertices_where(scene.mesh, [&](const Vec3& p) { return p.x < cell / 2; });
  scene.patch = even_patch(vertices_where(scene.mesh, [&](const Vec3& p) { return p.x > 1 - cell / 2; }));
  scene.load = 40;
  scene.probe = {.stiffness = 700, .depth = 0.05};
  scene.steps_per_sample = {6, 12, 25, 50, 100, 120, 200, 400};
  scene.reference_steps_per_sample = 2000;
  return scene;
}

/// Few steps over a fifth of the time.
PrecisionScene shortened(PrecisionScene scene) {
  scene.duration /= 5;
  scene.samples = 1;
  std::erase_if(scene.steps_per_sample, [](int n) { return n < 25 || n > 200; });
  scene.reference_steps_per_sample /= 2;
  return scene;
}

}  // namespace

double Patch::deflection(const Eigen::VectorXd& u) const noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) sum += weights[i] * u[3 * static_cast<Eigen::Index>(vertices[i]) + 2];
  return sum;
}

void Patch::add_force(double force, Eigen::VectorXd& f) const noexcept {
  for (std::size_t i = 0; i < vertices.size(); ++i) f[3 * static_cast<Eigen::Index>(vertices[i]) + 2] += weights[i] * force;
}

std::optional<PrecisionScene> precision_scene(std::string_view name, Extent extent) {
  std::optional<PrecisionScene> scene;
  if (name == "membrane") scene = membrane(extent);
  if (name == "membrane-stiff") scene = membrane_stiff(extent);
  if (name == "cantilever") scene = cantilever(extent);
  if (!scene) return std::nullopt;
  scene->name = name;
  return extent == Extent::full ? std::move(*scene) : shortened(std::move(*scene));
}

std::vector<PrecisionMethod> precision_methods(Extent extent) {
  constexpr auto kPcg = LinearSolver::conjugate_gradients;
  constexpr auto kCholesky = LinearSolver::cholesky;
  constexpr auto kPrefactored = LinearSolver::prefactored;
  const auto with = [](Method method, LinearSolver solver, int newton, int modes = 0) {
    IntegratorOptions options;
    options.method = method;
    options.solver = solver;
    options.newton_iterations = newton;
    options.modes = modes;
    return options;
  };
  std::vector<PrecisionMethod> methods{
      {"chosen", {}, Elasticity::corotated, true},
      {"velocity Verlet", with(Method::velocity_verlet, kPcg, 1)},
      {"velocity Verlet (linear)", with(Method::velocity_verlet, kPcg, 1), Elasticity::linear},
      {"backward Euler 1x PCG", with(Method::backward_euler, kPcg, 1)},
      {"Newmark 1x PCG", with(Method::newmark, kPcg, 1)},
      {"Newmark Newton PCG", with(Method::newmark, kPcg, 10)},
      {"Newmark Newton Cholesky", with(Method::newmark, kCholesky, 10)},
      {"Newmark 2x prefactored", with(Method::newmark, kPrefactored, 2)},
      {"TR-BDF2 Newton PCG", with(Method::tr_bdf2, kPcg, 10)},
      {"TR-BDF2 2x prefactored", with(Method::tr_bdf2, kPrefactored, 2)},
      {"projective 1x", with(Method::projective, kPrefactored, 1)},
      {"projective 3x", with(Method::projective, kPrefactored, 3)},
      {"modal 20 (linear)", with(Method::modal, kPrefactored, 1, 20), Elasticity::linear},
      {"modal 100 (linear)", with(Method::modal, kPrefactored, 1, 100), Elasticity::linear},
  };
  if (extent == Extent::brief) {
    std::erase_if(methods, [](const PrecisionMethod& m) { return m.options.modes > 20 || m.options.solver == kCholesky; });
  }
  return methods;
}

}  // namespace tactus::sim::study
