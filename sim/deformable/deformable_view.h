// SPDX-License-Identifier: Apache-2.0
/// Deformable objects as shown at a client; the rest shape before the first show(). Needs no finite elements.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/sim/deformable/deformable_probes.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/touchable.h>

namespace tactus::sim {

class DeformableView final : public Touchable {
 public:
  /// in   objects  surfaces at rest, one per deformable object of the scene; they outlive the view
  DeformableView(const Scene& scene, std::span<const TraceDeformable> objects);

  /// Set the shape that users see from now on.   in  displacements  V x 3, as Replica::displacements, 2^-position_exp m   no
  /// allocation
  void show(std::size_t object, std::span<const std::array<std::int32_t, 3>> displacements, unsigned position_exp) noexcept;
  Touch touch(std::size_t user, const DeviceSample& device, bool held) noexcept override;

 private:
  struct Surface {
    explicit Surface(const TriMesh& mesh)
        : rest(mesh), topology(mesh), inside(mesh, topology), vertices(mesh.vertices), next(mesh.vertices), tree(mesh) {}

    const TriMesh& rest;
    MeshTopology topology;
    InsideTest inside;
    std::vector<Vec3> vertices, next;
    AabbTree tree;
  };
  static std::vector<std::unique_ptr<Surface>> surfaces(std::span<const TraceDeformable> objects);
  std::vector<TouchedSurface> touched(const Scene& scene) const;

  std::vector<std::unique_ptr<Surface>> surfaces_;  // others refer to them
  DeformableProbes probes_;
};

}  // namespace tactus::sim
