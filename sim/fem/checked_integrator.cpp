// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/checked_integrator.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include <tactus/base/rule.h>

namespace tactus::sim {
namespace {

constexpr std::int64_t kEnergyEvery = 64;  ///< steps
constexpr double kEnergyFactor = 10;
constexpr double kTornFrom = 400;  ///< edge lengths: a vertex moves at least so far before an edge is 1000 times as long

double shortest_edge(const TetMesh& mesh) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const Tet& tet : mesh.tets)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < i; ++j) shortest = std::min(shortest, norm(mesh.vertices[tet[i]] - mesh.vertices[tet[j]]));
  return shortest;
}

/// Name the tetrahedron at fault; -1: none.
void blame(Diagnostic& error, std::int64_t tetrahedron) {
  if (tetrahedron < 0) return;
  error.kind = "tetrahedron";
  error.element = static_cast<std::uint64_t>(tetrahedron);
}

/// The tetrahedron with the edge that is stretched most, or -1.
std::int64_t most_stretched(const TetMesh& mesh, const Eigen::VectorXd& u) {
  const auto moved = [&](std::uint32_t v) {
    const auto at = 3 * static_cast<Eigen::Index>(v);
    return mesh.vertices[v] + Vec3{u[at], u[at + 1], u[at + 2]};
  };
  double most = 0;
  std::int64_t out = -1;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const Tet& tet = mesh.tets[t];
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double stretch = norm(moved(tet[i]) - moved(tet[j])) / norm(mesh.vertices[tet[i]] - mesh.vertices[tet[j]]);
        if (!(stretch > most)) continue;
        most = stretch;
        out = static_cast<std::int64_t>(t);
      }
    }
  }
  return out;
}

/// Elastic energy of a strain that is only rounding.
double rounding_energy(const FemModel& model) {
  const auto& materials = model.options().materials;
  double sum = 0;
  for (std::size_t i = 0; i < model.mesh().tets.size(); ++i)
    sum += materials[materials.size() == 1 ? 0 : i].young * volume(model.mesh(), i);
  const double strain = 1e-12;
  return sum * strain * strain;
}

/// Byte for byte, as fast as the machine can.
bool same(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

}  // namespace

CheckedIntegrator::CheckedIntegrator(FemModel& model, const IntegratorOptions& options)
    : model_(model),
      options_(options),
      next_(model.rest()),
      far_(kTornFrom * shortest_edge(model.mesh())),
      rounding_(rounding_energy(model)),
      last_(model.rest()) {}

tl::expected<StepReport, Diagnostic> CheckedIntegrator::step(const Eigen::VectorXd& f, FemState& state) {
  const auto usable = [&](const Eigen::VectorXd& x) { return x.size() == model_.size() && finite(x); };
  const bool known = !interrupted_ && same(state.u, last_.u) && same(state.v, last_.v);  // and thus finite
  if (!usable(f) || (!known && !(usable(state.u) && usable(state.v))))
    return tl::unexpected(Diagnostic{.error = fail(Errc::invalid_argument, "R-FEM-5").value(),
                                     .step = steps_,
                                     .remedy = "give finite numbers, three for each vertex"});
  edited_ = std::exchange(interrupted_, true) || !known;

  auto report = advance(f, state, next_);
  if (!report) {
    Diagnostic error = std::move(report.error());
    error.step = steps_;
    if (error.kind == nullptr) blame(error, most_stretched(model_.mesh(), state.u));
    if (error.remedy.empty()) error.remedy = divergence_remedy(model_, options_);
    return tl::unexpected(std::move(error));
  }
  if (diverged(f, state)) return tl::unexpected(divergence());
  ++steps_;
  interrupted_ = false;
  std::swap(state, next_);
  return report;
}

bool CheckedIntegrator::finite(const Eigen::VectorXd& x) const noexcept {
  return kernels_.finite(x.data(), static_cast<std::size_t>(x.size()));
}

bool CheckedIntegrator::diverged(const Eigen::VectorXd& f, const FemState& before) {
  if (edited_) {
    referenced_ = false;
    moved_ = std::numeric_limits<double>::infinity();
  }
  const Motion motion = kernels_.motion(f.data(), before.u.data(), next_.u.data(), next_.v.data(), last_.u.data(), last_.v.data(),
                                        static_cast<std::size_t>(f.size()));
  if (!motion.finite) return true;
  work_ += std::abs(motion.work);
  moved_ += motion.farthest;
  if (moved_ > far_) {
    moved_ = 0;
    if (model_.broken_element(next_.u) >= 0) return true;
  }
  return may_gain_energy() && steps_ % kEnergyEvery == 0 && gained_energy();
}

bool CheckedIntegrator::gained_energy() {
  const double kinetic = 0.5 * next_.v.cwiseAbs2().dot(model_.lumped_mass());
  const double energy = kinetic + model_.energy(next_.u);
  if (!std::exchange(referenced_, true)) {
    reference_ = energy;
    work_ = 0;
    return false;
  }
  return !(energy <= kEnergyFactor * largest_swing() * (reference_ + work_) + rounding_);
}

Diagnostic CheckedIntegrator::divergence() const {
  const std::int64_t broken = model_.broken_element(next_.u);
  Diagnostic out{
      .error = fail(Errc::invalid_argument, "R-FEM-6").value(), .step = steps_, .remedy = divergence_remedy(model_, options_)};
  blame(out, broken >= 0 ? broken : most_stretched(model_.mesh(), next_.u));
  return out;
}

}  // namespace tactus::sim
