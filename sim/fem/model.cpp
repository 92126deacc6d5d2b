// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/model.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/sim/fem/element.h>
#include <tactus/sim/fem/element_assembly.h>
#include <tactus/sim/fem/frequency.h>

namespace tactus::sim {
namespace {

tl::unexpected<Diagnostic> refuse(RuleName rule, const char* kind, std::size_t element, const char* remedy = "") {
  return tl::unexpected(
      Diagnostic{.error = fail(Errc::invalid, rule).value(), .kind = kind, .element = element, .remedy = remedy});
}

bool valid(const Material& m) {
  constexpr double kLargest = 1e15;
  return m.young > 0 && m.young <= kLargest && m.density > 0 && m.density <= kLargest && m.poisson > -1 && m.poisson < 0.5;
}

bool valid_damping(double d) { return d >= 0 && std::isfinite(d); }

tl::expected<void, Diagnostic> check(const TetMesh& mesh, const FemOptions& options) {
  TACTUS_CHECK(tactus::sim::check(mesh));
  if (options.materials.size() != 1 && options.materials.size() != mesh.tets.size()) return refuse("R-FEM-2", nullptr, 0);
  for (std::size_t i = 0; i < options.materials.size(); ++i) {
    if (!valid(options.materials[i]))
      return refuse(
          "R-FEM-1", "material", i,
          "Young's modulus and density in (0, 1e15], Poisson's ratio above -1 and below 0.5; incompressible material needs "
          "0.499 or less");
  }
  for (const std::uint32_t v : options.fixed)
    if (v >= mesh.vertices.size()) return refuse("R-FEM-3", "vertex", v);
  if (!valid_damping(options.mass_damping) || !valid_damping(options.stiffness_damping)) return refuse("R-FEM-4", nullptr, 0);
  return {};
}

const Material& material(const FemOptions& options, std::size_t tet) {
  return options.materials[options.materials.size() == 1 ? 0 : tet];
}

std::vector<Lame> lame(const TetMesh& mesh, const FemOptions& options) {
  std::vector<Lame> out(mesh.tets.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Material& m = material(options, i);
    out[i] = {m.young / (2 * (1 + m.poisson)), m.young * m.poisson / ((1 + m.poisson) * (1 - 2 * m.poisson))};
  }
  return out;
}

double shortest_edge(const TetMesh& mesh) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const Tet& t : mesh.tets)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) shortest = std::min(shortest, norm(mesh.vertices[t[i]] - mesh.vertices[t[j]]));
  return shortest;
}

constexpr double kTorn = 1e3;  // times the rest length: no object recovers from a stretch beyond this

}  // namespace

struct FemModel::Impl {
  Impl(TetMesh m, FemOptions o)
      : mesh(std::move(m)),
        options(std::move(o)),
        fixed(mesh.vertices.size(), 0),
        elements(mesh, lame(mesh, options), options.elasticity == Elasticity::corotated) {
    for (const std::uint32_t v : options.fixed) fixed[v] = 1;
    std::vector<int> free_vertex(mesh.vertices.size(), -1);
    int free_count = 0;
    for (std::size_t v = 0; v < fixed.size(); ++v) {
      for (int c = 0; c < 3; ++c) (fixed[v] != 0 ? fixed_dofs : free_dofs).push_back(3 * static_cast<int>(v) + c);
      if (fixed[v] == 0) free_vertex[v] = free_count++;
    }
    assembly = Assembly(elements, free_vertex, free_count);
    make_masses();
    shortest = shortest_edge(mesh);
  }

  void make_masses();
  bool corotated() const { return options.elasticity == Elasticity::corotated; }

  TetMesh mesh;
  FemOptions options;
  std::vector<std::uint8_t> fixed;  // by vertex
  std::vector<int> free_dofs, fixed_dofs;
  Elements elements;
  Assembly assembly;
  Eigen::VectorXd lumped;
  SparseMatrix mass;
  double total_mass = 0;
  double shortest = 0;  // rest edge [m]
};

void FemModel::Impl::make_masses() {
  lumped = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(mesh.vertices.size()));
  if (options.mass == MassMatrix::consistent) assembly.prepare(mass);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const double m = material(options, e).density * volume(mesh, e);
    total_mass += m;
    for (const std::uint32_t v : mesh.tets[e]) lumped.segment<3>(3 * static_cast<Eigen::Index>(v)).array() += m / 4;
    if (options.mass == MassMatrix::lumped) continue;
    ElementMatrix block;
    for (std::size_t i = 0; i < 16; ++i)
      for (std::size_t c = 0; c < 3; ++c) block[i].m[c][c] = i / 4 == i % 4 ? m / 10 : m / 20;
    assembly.add(e, block, mass);
  }
  if (options.mass == MassMatrix::consistent) return;
  const auto n = static_cast<Eigen::Index>(free_dofs.size());
  mass.resize(n, n);
  if (n == 0) return;  // as in Assembly
  mass.reserve(Eigen::VectorXi::Constant(n, 1));
  for (Eigen::Index i = 0; i < n; ++i) mass.insert(i, i) = lumped[free_dofs[static_cast<std::size_t>(i)]];
  mass.makeCompressed();
}

tl::expected<FemModel, Diagnostic> FemModel::create(TetMesh mesh, FemOptions options) {
  TACTUS_CHECK(check(mesh, options));
  return FemModel(std::make_unique<Impl>(std::move(mesh), std::move(options)));
}

FemModel::FemModel(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
FemModel::FemModel(FemModel&&) noexcept = default;
FemModel& FemModel::operator=(FemModel&&) noexcept = default;
FemModel::~FemModel() = default;

const TetMesh& FemModel::mesh() const noexcept { return impl_->mesh; }
const FemOptions& FemModel::options() const noexcept { return impl_->options; }
Eigen::Index FemModel::size() const noexcept { return impl_->lumped.size(); }
std::span<const int> FemModel::free_dofs() const noexcept { return impl_->free_dofs; }
bool FemModel::is_fixed(std::uint32_t vertex) const noexcept { return impl_->fixed[vertex] != 0; }
FemState FemModel::rest() const { return {Eigen::VectorXd::Zero(size()), Eigen::VectorXd::Zero(size())}; }
const Eigen::VectorXd& FemModel::lumped_mass() const noexcept { return impl_->lumped; }
const SparseMatrix& FemModel::mass_matrix() const noexcept { return impl_->mass; }
double FemModel::total_mass() const noexcept { return impl_->total_mass; }

void FemModel::internal_forces(const Eigen::VectorXd& u, Eigen::VectorXd& k) noexcept {
  k.resize(size());
  impl_->elements.forces(u.data(), k.data());
  for (const int i : impl_->fixed_dofs) k[i] = 0;
}

double FemModel::energy(const Eigen::VectorXd& u) noexcept { return impl_->elements.energy(u.data()); }

void FemModel::stiffness(const Eigen::VectorXd& u, SparseMatrix& matrix) {
  impl_->assembly.prepare(matrix);
  impl_->elements.turn(u.data());
  for (std::size_t e = 0; e < impl_->elements.size(); ++e)
    impl_->assembly.add(e, rotated_stiffness(impl_->elements, e, impl_->corotated()), matrix);
}

void FemModel::tangent(const Eigen::VectorXd& u, SparseMatrix& matrix) {
  if (!impl_->corotated()) return stiffness(u, matrix);
  impl_->assembly.prepare(matrix);
  impl_->elements.turn(u.data());
  for (std::size_t e = 0; e < impl_->elements.size(); ++e)
    impl_->assembly.add(e, tactus::sim::tangent(impl_->elements, e, u.data()), matrix);
}

double FemModel::largest_frequency() const {
  SparseMatrix matrix;
  impl_->assembly.prepare(matrix);
  for (std::size_t e = 0; e < impl_->elements.size(); ++e)
    impl_->assembly.add(e, rotated_stiffness(impl_->elements, e, false), matrix);
  return tactus::sim::largest_frequency(matrix, impl_->mass);
}

std::int64_t FemModel::broken_element(const Eigen::VectorXd& u) const noexcept {
  // A vertex may move by this much before any edge can be torn; almost every call ends here.
  const double safe = (kTorn - 1) * impl_->shortest / 4;
  bool all_safe = true;
  for (const double x : u) all_safe &= std::abs(x) < safe;
  if (all_safe) return -1;
  const auto at = [&](std::uint32_t v) {
    const Eigen::Index i = 3 * static_cast<Eigen::Index>(v);
    return impl_->mesh.vertices[v] + Vec3{u[i], u[i + 1], u[i + 2]};
  };
  for (std::size_t e = 0; e < impl_->mesh.tets.size(); ++e) {
    const Tet& t = impl_->mesh.tets[e];
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) {
        const double now = norm(at(t[i]) - at(t[j])), rest = norm(impl_->mesh.vertices[t[i]] - impl_->mesh.vertices[t[j]]);
        if (!(now <= kTorn * rest)) return static_cast<std::int64_t>(e);
      }
    }
  }
  return -1;
}

void add_force(std::span<const std::uint32_t> corners, std::span<const double> weights, const Vec3& force,
               Eigen::VectorXd& f) noexcept {
  for (std::size_t i = 0; i < corners.size(); ++i)
    f.segment<3>(3 * static_cast<Eigen::Index>(corners[i])) += weights[i] * Eigen::Vector3d(force.x, force.y, force.z);
}

}  // namespace tactus::sim
