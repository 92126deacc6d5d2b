// SPDX-License-Identifier: Apache-2.0
#include <tactus/elastic/elastic_solver.h>

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

using Method = ElasticBody::Method;

constexpr int kRounds = 2, kIterations = 4;
constexpr double kStill = 0x1p-30;  // [m/s]
constexpr double kTrapezoid =
    2 - 0x1.6a09e667f3bcdp+0;  // 2 - sqrt(2): fraction of a step of TR-BDF2 that its first stage reaches

/// [s] What a stage of an implicit step reaches, or a sub-step.
double reach_of(const ElasticBody& body, double step) noexcept {
  if (body.method == Method::velocity_verlet) return step / body.sub_steps;
  return body.method == Method::tr_bdf2 ? kTrapezoid * step / 2 : step;
}

/// exp(-x), x >= 0.
double decay(double x) noexcept {
  int halved = 0;
  for (; x > 0.1; ++halved) x /= 2;
  double e = (1 - x / 2 + x * x / 12) / (1 + x / 2 + x * x / 12);
  for (; halved > 0; --halved) e *= e;
  return e;
}

}  // namespace

ElasticSolver::ElasticSolver(const Scene& scene, const DeformableObject& object)
    : object_(object),
      body_(*object.body),
      position_exp_(scene.grid.position),
      ticks_(object.frame_period / 256),
      step_(static_cast<double>(ticks_) / scene.tick_rate),
      reach_(reach_of(body_, step_)),
      rest_(elastic_rest(object, scene.grid.position)),
      elimination_(elimination(body_, rest_.size())),
      elements_(body_, rest_),
      mass_factor_((1 / reach_ + body_.mass_damping) / reach_),
      stiffness_factor_(1 + body_.stiffness_damping / reach_),
      u_(3 * rest_.size()),
      ahead_(u_.size()),
      force_(u_.size()),
      start_(u_.size()),
      begun_(u_.size()),
      residual_(3 * elimination_.order.size()),
      z_(residual_.size()),
      direction_(residual_.size()),
      along_(residual_.size()),
      rotations_(rest_.size()) {
  if (body_.method != Method::velocity_verlet) {
    matrix_.emplace(body_, elimination_, elements_, mass_factor_, stiffness_factor_);
    return;
  }
  decay_ = decay(body_.mass_damping * reach_ / 2);
  kick_ = body_.mass_damping > 0 ? (1 - decay_) / body_.mass_damping : reach_ / 2;
}

bool ElasticSolver::moves(const ElasticState& state) const noexcept {
  return !std::ranges::all_of(state.velocity, [](double v) { return std::abs(v) < kStill; });
}

void ElasticSolver::weigh(std::span<double> load) const noexcept {
  for (std::size_t v = 0; v < rest_.size(); ++v) {
    const double mass = elements_.mass()[v];
    load[3 * v] = mass * body_.gravity.x;
    load[3 * v + 1] = mass * body_.gravity.y;
    load[3 * v + 2] = mass * body_.gravity.z;
  }
}

void ElasticSolver::add(const ElasticTouch::Push& push, std::span<double> load) const noexcept {
  for (std::size_t r = 0; r < 3; ++r) {
    double* at = load.data() + 3 * std::size_t{object_.triangles[push.triangle][r]};
    at[0] += push.weights[r] * push.force.x / ticks_;
    at[1] += push.weights[r] * push.force.y / ticks_;
    at[2] += push.weights[r] * push.force.z / ticks_;
  }
}

/// z = A^-1 r, as if every vertex had turned with what surrounds it.
void ElasticSolver::precondition() noexcept {
  for (std::size_t i = 0; i < elimination_.order.size(); ++i) {
    const Rotation& R = rotations_[elimination_.order[i]];
    for (std::size_t a = 0; a < 3; ++a)
      z_[3 * i + a] = R[a] * residual_[3 * i] + R[3 + a] * residual_[3 * i + 1] + R[6 + a] * residual_[3 * i + 2];
  }
  matrix_->solve(z_);
  for (std::size_t i = 0; i < elimination_.order.size(); ++i) {
    const Rotation& R = rotations_[elimination_.order[i]];
    const double x = z_[3 * i], y = z_[3 * i + 1], z = z_[3 * i + 2];
    for (std::size_t a = 0; a < 3; ++a) z_[3 * i + a] = R[3 * a] * x + R[3 * a + 1] * y + R[3 * a + 2] * z;
  }
}

/// along = A direction; returns direction . along.   pre  `ahead_` is 0 at fixed vertices
double ElasticSolver::product() noexcept {
  for (std::size_t i = 0; i < direction_.size(); ++i) ahead_[3 * std::size_t{elimination_.order[i / 3]} + i % 3] = direction_[i];
  elements_.multiply(ahead_, force_);
  double sum = 0;
  for (std::size_t i = 0; i < direction_.size(); ++i) {
    const std::uint32_t v = elimination_.order[i / 3];
    along_[i] = mass_factor_ * elements_.mass()[v] * direction_[i] + stiffness_factor_ * force_[3 * std::size_t{v} + i % 3];
    sum += direction_[i] * along_[i];
  }
  return sum;
}

void ElasticSolver::solve_round(std::span<const double> load) noexcept {
  for (std::size_t i = 0; i < u_.size(); ++i) ahead_[i] = u_[i] + body_.stiffness_damping * ((u_[i] - start_[i]) / reach_);
  elements_.forces(ahead_, force_);
  elements_.vertex_rotations(rotations_);
  const double rate = 1 / reach_ + body_.mass_damping;
  for (std::size_t i = 0; i < residual_.size(); ++i) {
    const std::uint32_t v = elimination_.order[i / 3];
    const std::size_t at = 3 * std::size_t{v} + i % 3;
    const double speed = (u_[at] - start_[at]) / reach_;
    residual_[i] = -(elements_.mass()[v] * (rate * speed - begun_[at] / reach_) + force_[at] - load[at]);
  }
  std::ranges::fill(direction_, 0);
  double before = 0;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    precondition();
    double now = 0;
    for (std::size_t i = 0; i < z_.size(); ++i) now += residual_[i] * z_[i];
    if (!(now > 0)) return;
    const double back = iteration == 0 ? 0 : now / before;
    before = now;
    for (std::size_t i = 0; i < direction_.size(); ++i) direction_[i] = z_[i] + back * direction_[i];
    const double far = now / product();
    for (std::size_t i = 0; i < direction_.size(); ++i) {
      u_[3 * std::size_t{elimination_.order[i / 3]} + i % 3] += far * direction_[i];
      residual_[i] -= far * along_[i];
    }
  }
}

/// u_ = end of the stage that begins with start_ and begun_, from u_ on.
void ElasticSolver::solve_stage(std::span<const double> load) noexcept {
  for (int round = 0; round < kRounds; ++round) solve_round(load);
}

void ElasticSolver::backward_euler(std::span<const double> load, ElasticState& state) noexcept {
  start_ = state.displacement;
  begun_ = state.velocity;
  for (std::size_t i = 0; i < u_.size(); ++i) u_[i] = start_[i] + step_ * begun_[i];
  solve_stage(load);
  for (std::size_t i = 0; i < u_.size(); ++i) state.velocity[i] = (u_[i] - start_[i]) / step_;
  state.displacement = u_;
}

/// [Hosea and Shampine 1996] The trapezoidal rule up to kTrapezoid of the step, then the backward difference over both parts.
void ElasticSolver::tr_bdf2(std::span<const double> load, ElasticState& state) noexcept {
  auto& [u, w, k] = state;
  const double g = kTrapezoid, old = (1 - g) * (1 - g) / (g * (2 - g)), fresh = 1 + old;
  const double left = 1 - reach_ * body_.mass_damping, rate = 1 + reach_ * body_.mass_damping;
  for (const std::uint32_t v : elimination_.order) {
    for (std::size_t i = 3 * std::size_t{v}; i < 3 * std::size_t{v} + 3; ++i) {
      start_[i] = u[i] + reach_ * w[i];
      begun_[i] = left * w[i] + reach_ * (load[i] - k[i]) / elements_.mass()[v];
      u_[i] = u[i] + g * step_ * w[i];
    }
  }
  solve_stage(load);
  for (std::size_t i = 0; i < u_.size(); ++i) {
    const double speed = (u_[i] - start_[i]) / reach_;
    start_[i] = fresh * u_[i] - old * u[i];
    begun_[i] = fresh * speed - old * w[i];
    u_[i] += (1 - g) * step_ * speed;
  }
  solve_stage(load);
  for (const std::uint32_t v : elimination_.order) {
    for (std::size_t i = 3 * std::size_t{v}; i < 3 * std::size_t{v} + 3; ++i) {
      w[i] = (u_[i] - start_[i]) / reach_;
      k[i] = load[i] - elements_.mass()[v] * (rate * w[i] - begun_[i]) / reach_;
    }
  }
  u = u_;
}

/// What the forces do to the velocities in half a sub-step.
void ElasticSolver::kick(std::span<const double> load, ElasticState& state) const noexcept {
  for (const std::uint32_t v : elimination_.order) {
    const double by = kick_ / elements_.mass()[v];
    for (std::size_t i = 3 * std::size_t{v}; i < 3 * std::size_t{v} + 3; ++i)
      state.velocity[i] = decay_ * state.velocity[i] + by * (load[i] - state.force[i]);
  }
}

void ElasticSolver::velocity_verlet(std::span<const double> load, ElasticState& state) noexcept {
  auto& [u, w, k] = state;
  for (int part = 0; part < body_.sub_steps; ++part) {
    kick(load, state);
    for (std::size_t i = 0; i < u.size(); ++i) {
      u[i] += reach_ * w[i];
      ahead_[i] = u[i] + body_.stiffness_damping * w[i];
    }
    elements_.forces(ahead_, k);
    kick(load, state);
  }
}

bool ElasticSolver::step(std::span<const double> load, ElasticState& state) noexcept {
  switch (body_.method) {
    case Method::backward_euler:
      backward_euler(load, state);
      break;
    case Method::tr_bdf2:
      tr_bdf2(load, state);
      break;
    case Method::velocity_verlet:
      velocity_verlet(load, state);
      break;
  }
  const double largest = std::ldexp(1.0, 27 - static_cast<int>(position_exp_));
  return std::ranges::all_of(state.displacement, [largest](double u) { return std::abs(u) <= largest; });
}

}  // namespace tactus
