// SPDX-License-Identifier: Apache-2.0
/// One deformable object: finite elements at the low rate, and its surface.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sim/contact/aabb_tree.h"
#include "sim/contact/inside.h"
#include "sim/deformable/deformable_world.h"
#include "sim/fem/error_estimate.h"
#include "sim/fem/integrator.h"

namespace tactus {

/// What a scene says about an object, as finite elements take it.
FemOptions fem_options(const SceneDeformable& object);
/// The scene's method, or the one that suits it, and why.
Choice chosen_method(const SceneDeformable& object, const FemModel& model);

class DeformableBody {
 public:
  /// err  R-TET-n, R-FEM-1..4, 7, 8
  static tl::expected<std::unique_ptr<DeformableBody>, FemError> create(const SceneDeformable& object, const Vec3& gravity,
                                                                        std::uint32_t estimate_every);

  /// Let a force [N] act on a triangle of the surface in this tick.   in  weights  of its corners
  void push(std::uint32_t triangle, std::span<const double, 3> weights, const Vec3& force) noexcept;
  /// End a tick; true when it was the last of a period, and the object has a new shape.
  /// err  R-FEM-6, R-FEM-7; the shape before is kept
  tl::expected<bool, FemError> tick();

  const TetSurface& surface() const noexcept { return surface_; }
  const MeshTopology& topology() const noexcept { return topology_; }
  const Inside& inside() const noexcept { return inside_; }
  std::span<const Vec3> vertices() const noexcept { return vertices_; }  ///< of the surface now, world frame
  const AabbTree& tree() const noexcept { return tree_; }                ///< fitted to them
  const Choice& choice() const noexcept { return choice_; }
  const FemState& state() const noexcept { return state_; }
  const DeformationTime& time() const noexcept { return time_; }
  const std::optional<ErrorEstimate>& estimate() const noexcept { return estimate_; }

 private:
  DeformableBody(FemModel model, const SceneDeformable& object, const Vec3& gravity);
  void move_surface() noexcept;

  FemModel model_;
  Choice choice_;
  std::unique_ptr<Integrator> integrator_;
  std::optional<ErrorEstimate> estimate_;
  FemState state_;
  std::uint32_t rate_, phase_ = 0;  // ticks of this period that are done
  Eigen::VectorXd weight_;          // 3N [N] gravity
  Eigen::VectorXd pushed_, load_;   // 3N [N] sum of this period's pushes; what acts in the step
  TetSurface surface_;
  MeshTopology topology_;
  Inside inside_;
  std::vector<Vec3> vertices_;
  AabbTree tree_;
  DeformationTime time_;
};

}  // namespace tactus
