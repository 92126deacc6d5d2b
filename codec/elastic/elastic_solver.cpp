// SPDX-License-Identifier: Apache-2.0
#include <tactus/elastic/elastic_solver.h>

#include <algorithm>
#include <cmath>

#include <tactus/base/fixed.h>

namespace tactus {
namespace {

constexpr int kRounds = 2, kIterations = 4;
constexpr double kStill = 0x1p-30;  // [m/s]

std::vector<Vec3> in_metres(const DeformableObject& object, unsigned exp) {
  const double unit = std::ldexp(1.0, -static_cast<int>(exp));
  std::vector<Vec3> out;
  out.reserve(object.rest.size() + object.body->inner.size());
  for (const auto* list : {&object.rest, &object.body->inner})
    for (const Vec3i& p : *list) out.push_back({unit * p[0], unit * p[1], unit * p[2]});
  return out;
}

}  // namespace

ElasticSolver::ElasticSolver(const Scene& scene, const DeformableObject& object)
    : object_(object),
      body_(*object.body),
      position_exp_(scene.grid.position),
      ticks_(object.frame_period / 256),
      step_(static_cast<double>(ticks_) / scene.tick_rate),
      rest_(in_metres(object, scene.grid.position)),
      elimination_(elimination(body_, rest_.size())),
      elements_(body_, rest_),
      mass_share_((1 / step_ + body_.mass_damping) / step_),
      stiffness_share_(1 + body_.stiffness_damping / step_),
      matrix_(body_, elimination_, elements_, mass_share_, stiffness_share_),
      u_(3 * rest_.size()),
      ahead_(u_.size()),
      force_(u_.size()),
      residual_(3 * elimination_.order.size()),
      z_(residual_.size()),
      way_(residual_.size()),
      along_(residual_.size()),
      rotations_(rest_.size()) {}

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
  matrix_.solve(z_);
  for (std::size_t i = 0; i < elimination_.order.size(); ++i) {
    const Rotation& R = rotations_[elimination_.order[i]];
    const double x = z_[3 * i], y = z_[3 * i + 1], z = z_[3 * i + 2];
    for (std::size_t a = 0; a < 3; ++a) z_[3 * i + a] = R[3 * a] * x + R[3 * a + 1] * y + R[3 * a + 2] * z;
  }
}

/// along = A way; returns way . along.   pre  `ahead_` is 0 at fixed vertices
double ElasticSolver::product() noexcept {
  for (std::size_t i = 0; i < way_.size(); ++i) ahead_[3 * std::size_t{elimination_.order[i / 3]} + i % 3] = way_[i];
  elements_.multiply(ahead_, force_);
  double sum = 0;
  for (std::size_t i = 0; i < way_.size(); ++i) {
    const std::uint32_t v = elimination_.order[i / 3];
    along_[i] = mass_share_ * elements_.mass()[v] * way_[i] + stiffness_share_ * force_[3 * std::size_t{v} + i % 3];
    sum += way_[i] * along_[i];
  }
  return sum;
}

void ElasticSolver::solve_round(const ElasticState& from, std::span<const double> load) noexcept {
  for (std::size_t i = 0; i < u_.size(); ++i)
    ahead_[i] = u_[i] + body_.stiffness_damping * ((u_[i] - from.displacement[i]) / step_);
  elements_.forces(ahead_, force_);
  elements_.vertex_rotations(rotations_);
  const double rate = 1 / step_ + body_.mass_damping;
  for (std::size_t i = 0; i < residual_.size(); ++i) {
    const std::uint32_t v = elimination_.order[i / 3];
    const std::size_t at = 3 * std::size_t{v} + i % 3;
    const double speed = (u_[at] - from.displacement[at]) / step_;
    residual_[i] = -(elements_.mass()[v] * (rate * speed - from.velocity[at] / step_) + force_[at] - load[at]);
  }
  std::ranges::fill(way_, 0);
  double before = 0;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    precondition();
    double now = 0;
    for (std::size_t i = 0; i < z_.size(); ++i) now += residual_[i] * z_[i];
    if (!(now > 0)) return;
    const double back = iteration == 0 ? 0 : now / before;
    before = now;
    for (std::size_t i = 0; i < way_.size(); ++i) way_[i] = z_[i] + back * way_[i];
    const double far = now / product();
    for (std::size_t i = 0; i < way_.size(); ++i) {
      u_[3 * std::size_t{elimination_.order[i / 3]} + i % 3] += far * way_[i];
      residual_[i] -= far * along_[i];
    }
  }
}

bool ElasticSolver::step(std::span<const double> load, ElasticState& state) noexcept {
  for (std::size_t i = 0; i < u_.size(); ++i) u_[i] = state.displacement[i] + step_ * state.velocity[i];
  std::ranges::fill(ahead_, 0);
  for (int round = 0; round < kRounds; ++round) solve_round(state, load);
  const double largest = std::ldexp(1.0, 27 - static_cast<int>(position_exp_));
  bool whole = true;
  for (std::size_t i = 0; i < u_.size(); ++i) {
    whole = whole && std::abs(u_[i]) <= largest;
    state.velocity[i] = (u_[i] - state.displacement[i]) / step_;
    state.displacement[i] = u_[i];
  }
  return whole;
}

}  // namespace tactus
