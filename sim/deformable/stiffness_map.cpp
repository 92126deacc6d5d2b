// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/deformable/stiffness_map.h>

#include <Eigen/SparseCholesky>

#include <cmath>
#include <limits>

#include <tactus/base/rule.h>
#include <tactus/sim/deformable/deformable_body.h>
#include <tactus/sim/fem/linear_solver.h>
#include <tactus/sim/msd/msd.h>

namespace tactus::sim {
namespace {

constexpr double kSingular = 1e-12;  // smallest over largest pivot; about 1e-16 for a body that can move without force

/// Number of each degree of freedom among the free ones; -1: fixed.
std::vector<int> numbers_of(const FemModel& model) {
  std::vector<int> numbers(static_cast<std::size_t>(model.size()), -1);
  int next = 0;
  for (const int dof : model.free_dofs()) numbers[static_cast<std::size_t>(dof)] = next++;
  return numbers;
}

/// Unit normals of a surface's vertices, triangles weighted by area; zero where they cancel out.
std::vector<Vec3> vertex_normals(const TriMesh& mesh) {
  std::vector<Vec3> normals(mesh.vertices.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3& origin = mesh.vertices[a];
    const Vec3 area = cross(mesh.vertices[b] - origin, mesh.vertices[c] - origin);
    for (const std::uint32_t v : {a, b, c}) normals[v] = normals[v] + area;
  }
  for (Vec3& normal : normals)
    if (const double length = norm(normal); length > 0) normal = (1 / length) * normal;
  return normals;
}

/// |f| / |u . n| for a force on a triangle of the surface; 0 where too little is fixed to resist.
double local_stiffness(FemModel& model, const TetSurface& surface, const SurfaceContact& contact) {
  const std::vector<int> numbers = numbers_of(model);
  SparseMatrix matrix;
  model.stiffness(model.rest().u, matrix);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(matrix.rows()), u = f;
  for (std::size_t k = 0; k < 3; ++k) {
    const int first = numbers[3 * std::size_t{surface.vertex[surface.mesh.triangles[contact.triangle][k]]}];
    if (first >= 0)
      f.segment<3>(first) = contact.weights[k] * Eigen::Vector3d(contact.normal.x, contact.normal.y, contact.normal.z);
  }
  if (f.squaredNorm() == 0) return std::numeric_limits<double>::infinity();
  ConjugateGradients solver(matrix.rows(), 1e-3);
  solver.prepare(matrix);
  solver.solve(matrix, f, u);
  const double yields = u.dot(f);
  return std::isfinite(yields) && yields > 0 ? 1 / yields : 0;
}

}  // namespace

Result<StiffnessMap> stiffness_map(const SceneDeformable& object) {
  auto made = FemModel::create(object.mesh, fem_options(object));
  if (!made) return tl::unexpected(made.error().error);
  FemModel& model = *made;
  TetSurface surface = tactus::sim::surface(model.mesh());
  StiffnessMap map{std::move(surface.mesh), {}};
  map.stiffness.assign(map.surface.vertices.size(), std::numeric_limits<double>::infinity());
  if (model.free_dofs().empty()) return map;
  SparseMatrix matrix;
  model.stiffness(model.rest().u, matrix);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor{Eigen::SparseMatrix<double>(matrix)};
  const Eigen::VectorXd pivots = factor.info() == Eigen::Success ? factor.vectorD() : Eigen::VectorXd::Zero(1);
  if (!(pivots.minCoeff() > kSingular * pivots.maxCoeff())) return fail(Errc::internal, "R-FEM-7");

  const std::vector<int> numbers = numbers_of(model);
  const std::vector<Vec3> normals = vertex_normals(map.surface);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(matrix.rows());
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const int first = numbers[3 * std::size_t{surface.vertex[v]}];
    if (first < 0 || normals[v] == Vec3{}) continue;
    f.segment<3>(first) = Eigen::Vector3d(normals[v].x, normals[v].y, normals[v].z);
    map.stiffness[v] = 1 / factor.solve(f).segment<3>(first).norm();
    f.segment<3>(first).setZero();
  }
  return map;
}

Result<double> critical_stiffness(const SceneDeformable& object, const SurfaceContact& contact) {
  auto model = FemModel::create(object.mesh, fem_options(object));
  if (!model) return tl::unexpected(model.error().error);
  const TetSurface surface = tactus::sim::surface(model->mesh());
  double inverse = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t vertex = surface.vertex[surface.mesh.triangles[contact.triangle][k]];
    if (!model->is_fixed(vertex))
      inverse += contact.weights[k] * contact.weights[k] / model->lumped_mass()[3 * Eigen::Index{vertex}];
  }
  if (inverse == 0) return std::numeric_limits<double>::infinity();
  const double mass = 1 / inverse, stiffness = object.fixed.empty() ? 0 : local_stiffness(*model, surface, contact);
  const MsdObject alike{stiffness, object.mass_damping * mass + object.stiffness_damping * stiffness, mass};
  return critical_stiffness(alike, object.rate * kTick);
}

}  // namespace tactus::sim
