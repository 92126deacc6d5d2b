// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/deformable/deformable_body.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <utility>

namespace tactus::sim {
namespace {

constexpr std::array kMethods{Method::velocity_verlet, Method::backward_euler, Method::newmark, Method::tr_bdf2,
                              Method::projective};
constexpr std::array kSolvers{LinearSolver::conjugate_gradients, LinearSolver::cholesky, LinearSolver::prefactored};

/// Diagonal of the mesh's box [m].
double size_of(const TriMesh& mesh) {
  const Bounds box = bounds(mesh.vertices);
  return norm(box.high - box.low);
}

}  // namespace

FemOptions fem_options(const SceneDeformable& object) {
  FemOptions options;
  for (const SceneMaterial& m : object.materials) options.materials.push_back({m.young, m.poisson, m.density});
  options.fixed = object.fixed;
  options.elasticity = object.corotated ? Elasticity::corotated : Elasticity::linear;
  options.mass_damping = object.mass_damping;
  options.stiffness_damping = object.stiffness_damping;
  return options;
}

Choice chosen_method(const SceneDeformable& object, const FemModel& model) {
  Choice choice = choose(model, object.rate * kTick);
  for (const Method method : kMethods) {
    if (object.method != name(method)) continue;
    choice.options = suited(model, method, choice.options.step);
    choice.reason = "asked for; without, " + choice.reason;
  }
  for (const LinearSolver solver : kSolvers) {
    if (object.solver != name(solver)) continue;
    choice.options.solver = solver;
    choice.options.newton_iterations = IntegratorOptions().newton_iterations;
  }
  return choice;
}

DeformableBody::DeformableBody(FemModel model, const SceneDeformable& object, const Vec3& gravity, int parts)
    : model_(std::move(model)),
      choice_(chosen_method(object, model_)),
      parts_(parts),
      state_(model_.rest()),
      rate_(object.rate),
      weight_(model_.size()),
      pushed_(Eigen::VectorXd::Zero(model_.size())),
      load_(model_.size()),
      surface_(tactus::sim::surface(object.mesh)),
      topology_(surface_.mesh),
      inside_(surface_.mesh, topology_),
      vertices_(surface_.mesh.vertices),
      next_vertices_(vertices_),
      tree_(surface_.mesh),
      rest_speed_(0x1p-44 * size_of(surface_.mesh) / choice_.options.step) {
  const Eigen::VectorXd& mass = model_.lumped_mass();
  for (Eigen::Index i = 0; i < mass.size(); i += 3)
    weight_.segment<3>(i) = mass[i] * Eigen::Vector3d(gravity.x, gravity.y, gravity.z);
  if (gravity == Vec3{}) resting_ = kRestSteps;
  choice_.options.step /= parts;
}

tl::expected<std::unique_ptr<DeformableBody>, Diagnostic> DeformableBody::create(const SceneDeformable& object,
                                                                                 const Vec3& gravity,
                                                                                 std::uint32_t estimate_every, int parts) {
  TACTUS_TRY(auto model, FemModel::create(object.mesh, fem_options(object)));
  std::unique_ptr<DeformableBody> body(new DeformableBody(std::move(model), object, gravity, parts));
  TACTUS_TRY(auto integrator, make_integrator(body->model_, body->choice_.options));
  body->integrator_ = std::move(integrator);
  if (estimate_every > 0) {
    TACTUS_TRY(auto estimate, ErrorEstimate::create(body->model_, body->choice_.options, estimate_every));
    body->estimate_.emplace(std::move(estimate));
    TACTUS_TRY(auto balance, EnergyBalance::create(body->model_));
    body->balance_.emplace(std::move(balance));
  }
  return body;
}

void DeformableBody::push(std::uint32_t triangle, std::span<const double, 3> weights, const Vec3& force) noexcept {
  Triangle corners = surface_.mesh.triangles[triangle];
  for (std::uint32_t& corner : corners) corner = surface_.vertex[corner];
  add_force(corners, weights, force, pushed_);
  pushed_any_ = pushed_any_ || force != Vec3{};
}

tl::expected<DeformableBody::Tick, Diagnostic> DeformableBody::tick() {
  if (++phase_ < rate_) return Tick::between;
  phase_ = 0;
  time_ = {};
  if (sleeps()) return Tick::slept;
  load_ = weight_ + pushed_ / static_cast<double>(rate_);
  pushed_.setZero();
  if (estimate_) estimate_->look(load_, state_);
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t cpu = std::clock();
  for (int part = 0; part < parts_; ++part) TACTUS_CHECK(integrator_->step(load_, state_));
  look_for_rest();
  move_surface();
  energy_.reset();
  time_ = {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
           static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC};
  if (balance_) balance_->add(load_, parts_ * choice_.options.step, state_);
  return Tick::stepped;
}

double DeformableBody::energy() noexcept {
  if (!energy_) energy_ = state_.v.cwiseAbs2().dot(model_.lumped_mass()) / 2 + model_.energy(state_.u) - weight_.dot(state_.u);
  return *energy_;
}

void DeformableBody::look_for_rest() noexcept {
  const bool moves = std::exchange(pushed_any_, false) || state_.v.cwiseAbs().maxCoeff() > rest_speed_;
  resting_ = moves ? 0 : resting_ + 1;
}

void DeformableBody::move_surface() noexcept {
  double farthest2 = 0;
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const auto u = state_.u.segment<3>(3 * static_cast<Eigen::Index>(surface_.vertex[i]));
    next_vertices_[i] = surface_.mesh.vertices[i] + Vec3{u[0], u[1], u[2]};
    const Vec3 displacement = next_vertices_[i] - vertices_[i];
    farthest2 = std::max(farthest2, dot(displacement, displacement));
  }
  reach_ = std::sqrt(farthest2);
}

void DeformableBody::show() noexcept {
  if (reach_ == 0) return;
  std::swap(vertices_, next_vertices_);
  tree_.refit(vertices_);
  reach_ = 0;
}

}  // namespace tactus::sim
