// SPDX-License-Identifier: Apache-2.0
/// One step of an elastic body: backward Euler, solved by two rounds of conjugate gradients with the matrix at rest, turned into the shape.
/// spec/55-elastic.md section 5. Internal to the library. binary64 in the written order: both ends must agree on every bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/elastic/elastic_matrix.h>
#include <tactus/elastic/elastic_touch.h>
#include <tactus/scene/scene.h>

namespace tactus {

/// Displacements [m] and velocities [m/s], 3 per vertex.
struct ElasticState {
  std::vector<double> displacement, velocity;
};

class ElasticSolver {
 public:
  /// pre  the object has a body and breaks no rule; `object` outlives this.   time 15 ms for 700 vertices; allocates
  ElasticSolver(const Scene& scene, const DeformableObject& object);

  std::size_t vertices() const noexcept { return rest_.size(); }
  std::span<const Vec3> rest() const noexcept { return rest_; }  ///< [m], those of the object first
  std::uint32_t ticks() const noexcept { return ticks_; }        ///< of a step
  std::uint32_t position_exp() const noexcept { return position_exp_; }

  bool has_weight() const noexcept { return body_.gravity != Vec3{}; }
  /// Whether it moves without being pushed.
  bool moves(const ElasticState& state) const noexcept;
  /// load = weight of each vertex [N]
  void weigh(std::span<double> load) const noexcept;
  /// Add what a push does in one tick of a step.
  void add(const ElasticTouch::Push& push, std::span<double> load) const noexcept;
  /// Advance by a step under a load [N].   time 1.5 ms for 1900 tetrahedra and 700 vertices; no allocation
  /// out  false: the body has gone to pieces, and the state is of no use
  bool step(std::span<const double> load, ElasticState& state) noexcept;

 private:
  void solve_round(const ElasticState& from, std::span<const double> load) noexcept;
  void precondition() noexcept;
  double product() noexcept;

  const DeformableObject& object_;
  const ElasticBody& body_;
  std::uint32_t position_exp_, ticks_;
  double step_;  // [s]
  std::vector<Vec3> rest_;
  Elimination elimination_;
  ElasticElements elements_;
  double mass_share_, stiffness_share_;
  ElasticMatrix matrix_;
  std::vector<double> u_, ahead_, force_;           // 3 per vertex: end of the step; where forces act; forces
  std::vector<double> residual_, z_, way_, along_;  // 3 per place: of conjugate gradients
  std::vector<Rotation> rotations_;                 // by vertex
};

}  // namespace tactus
