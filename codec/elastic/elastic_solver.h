// SPDX-License-Identifier: Apache-2.0
/// One step of an elastic body, by the method that it declares. spec/55-elastic.md section 5. Internal to the library.
/// binary64 in the written order: both ends must agree on every bit.
///   backward Euler   one stage of two rounds of four conjugate gradients with the matrix at rest, turned into the shape
///   TR-BDF2          two such stages
///   velocity Verlet  one evaluation of the forces per sub-step
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <tactus/elastic/elastic_touch.h>
#include <tactus/mesh/elastic_elements.h>
#include <tactus/scene/scene.h>
#include <tactus/scene/scene_objects.h>

namespace tactus {

/// Displacements [m], velocities [m/s] and elastic forces [N], 3 per vertex.
struct ElasticState {
  explicit ElasticState(std::size_t vertices) : displacement(3 * vertices), velocity(3 * vertices), force(3 * vertices) {}
  std::vector<double> displacement, velocity, force;
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
  /// Advance by a step under a load [N]. No allocation
  /// time for 1900 tetrahedra and 700 vertices: backward Euler 1.6 ms, TR-BDF2 3.1 ms, velocity Verlet 0.11 ms per sub-step
  /// out  false: the body has gone to pieces, and the state is of no use
  bool step(std::span<const double> load, ElasticState& state) noexcept;

 private:
  void backward_euler(std::span<const double> load, ElasticState& state) noexcept;
  void tr_bdf2(std::span<const double> load, ElasticState& state) noexcept;
  void velocity_verlet(std::span<const double> load, ElasticState& state) noexcept;
  void kick(std::span<const double> load, ElasticState& state) const noexcept;
  void solve_stage(std::span<const double> load) noexcept;
  void solve_round(std::span<const double> load) noexcept;
  void precondition() noexcept;
  double product() noexcept;

  const DeformableObject& object_;
  const ElasticBody& body_;
  std::uint32_t position_exp_, ticks_;
  double step_, reach_;          // [s] of a step; of a stage or sub-step
  double decay_ = 1, kick_ = 0;  // of velocity Verlet: what half a sub-step leaves of a velocity; [s] that a force acts in it
  std::vector<Vec3> rest_;
  Elimination elimination_;
  ElasticElements elements_;
  double mass_factor_, stiffness_factor_;
  std::optional<ElasticMatrix> matrix_;                   // none: velocity Verlet
  std::vector<double> u_, ahead_, force_;                 // 3 per vertex: end of the stage; where forces act; forces
  std::vector<double> start_, begun_;                     // 3 per vertex: of a stage, a and b
  std::vector<double> residual_, z_, direction_, along_;  // 3 per order index: of conjugate gradients
  std::vector<Rotation> rotations_;                       // by vertex
};

}  // namespace tactus
