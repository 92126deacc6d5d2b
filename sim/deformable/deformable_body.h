// SPDX-License-Identifier: Apache-2.0
/// One deformable object: finite elements at the low rate, and its surface.
///
/// Sleep  No more steps are taken after kRestSteps steps in a row without a push, in which no vertex was faster than 2^-44 of the
///        object's size per step. A push wakes the object. It keeps its last state, velocities included; only jitter from the
///        rounding of its forces is left out. An object that has not moved since it was made wakes bit by bit as if it had never
///        slept. An object without a free vertex never takes a step, one without weight none before it is pushed.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/sim/contact/aabb_tree.h>
#include <tactus/sim/deformable/deformable_objects.h>
#include <tactus/sim/fem/error_estimate.h>
#include <tactus/sim/fem/integrator.h>

namespace tactus::sim {

/// FEM options of a scene's object.
FemOptions fem_options(const SceneDeformable& object);
/// The scene's method, or the one that suits it, and why.
Choice chosen_method(const SceneDeformable& object, const FemModel& model);

inline constexpr std::uint32_t kRestSteps = 32;  ///< longer than a client predicts motion (codec/deformable/main_state.h)

class DeformableBody {
 public:
  enum class Tick : std::uint8_t {
    between,  ///< no step was due
    slept,    ///< one was due and left out: nothing changes
    stepped   ///< there is a new shape: call show()
  };

  /// err  R-TET-n, R-FEM-1..4, 7, 8
  static tl::expected<std::unique_ptr<DeformableBody>, Diagnostic> create(const SceneDeformable& object, const Vec3& gravity,
                                                                          std::uint32_t estimate_every, int parts = 1);

  /// Let a force [N] act on a triangle of the surface in this tick.   in  weights  of its corners
  void push(std::uint32_t triangle, std::span<const double, 3> weights, const Vec3& force) noexcept;
  /// End a tick. A new shape is not seen before show().   err  R-FEM-6, R-FEM-7; the shape before is kept
  tl::expected<Tick, Diagnostic> tick();
  /// Largest displacement of a surface vertex when the new shape is shown [m].
  double reach() const noexcept { return reach_; }
  std::span<const Vec3> next_vertices() const noexcept { return next_vertices_; }  ///< of the surface when it is shown
  /// Give the surface its new shape.
  void show() noexcept;

  const TetSurface& surface() const noexcept { return surface_; }
  const MeshTopology& topology() const noexcept { return topology_; }
  const InsideTest& inside() const noexcept { return inside_; }
  std::span<const Vec3> vertices() const noexcept { return vertices_; }  ///< of the surface now, world frame
  bool begins_frame() const noexcept { return phase_ == 0; }             ///< this tick is the first of its shape
  const AabbTree& tree() const noexcept { return tree_; }                ///< fitted to them
  const Choice& choice() const noexcept { return choice_; }
  const FemState& state() const noexcept { return state_; }
  const DeformationTime& time() const noexcept { return time_; }  ///< of the step that was due last: 0 if left out
  const std::optional<ErrorEstimate>& estimate() const noexcept { return estimate_; }
  std::optional<EnergyBalance>& balance() noexcept { return balance_; }  ///< there with the estimate
  double energy() noexcept;                                              ///< DeformableObjects::energy

 private:
  DeformableBody(FemModel model, const SceneDeformable& object, const Vec3& gravity, int parts);
  bool sleeps() const noexcept { return model_.free_dofs().empty() || (resting_ >= kRestSteps && !pushed_any_); }
  void move_surface() noexcept;
  void look_for_rest() noexcept;

  FemModel model_;
  Choice choice_;
  int parts_;  // steps of a deformation
  std::unique_ptr<Integrator> integrator_;
  std::optional<ErrorEstimate> estimate_;
  std::optional<EnergyBalance> balance_;
  FemState state_;
  std::uint32_t rate_, phase_ = 0;  // ticks of this period that are done
  Eigen::VectorXd weight_;          // 3N [N] gravity
  Eigen::VectorXd pushed_, load_;   // 3N [N] sum of this period's pushes; what acts in the step
  TetSurface surface_;
  MeshTopology topology_;
  InsideTest inside_;
  std::vector<Vec3> vertices_, next_vertices_;
  AabbTree tree_;
  DeformationTime time_;
  double reach_ = 0;
  std::optional<double> energy_;  // [J] of the last shape, once it was asked for
  double rest_speed_;             // [m/s] slower than this a vertex moves by rounding only
  std::uint32_t resting_ = 0;     // steps in a row
  bool pushed_any_ = false;       // in this period
};

}  // namespace tactus::sim
