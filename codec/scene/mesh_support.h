// SPDX-License-Identifier: Apache-2.0
/// What a scene with deformable objects needs beyond one without. A program links it only if it can come to have such an object: by
/// SceneBuilder::deformable(), by reading a declaration, or by Scene::create() of a list that it made itself. Internal to the library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include <tactus/base/rule.h>
#include <tactus/scene/scene.h>

namespace tactus {

class DeformableDecoder;
class FollowedShape;

struct MeshSupport {
  /// Rules of one object, its basis and its body.   pre  those before it in this list found none
  RuleName (*broken_rule)(const DeformableObject& object) noexcept;
  bool (*is_solid)(const DeformableObject& object, unsigned position_exp);
  bool (*steps_stably)(const DeformableObject& object, unsigned position_exp, std::uint32_t tick_rate);
  std::uint64_t (*elastic_work)(const SceneSpec& spec);

  void (*compute_basis)(DeformableObject& object);  ///< if it asks for one that both ends compute
  std::shared_ptr<const VertexHierarchy> (*hierarchy)(const DeformableObject& object);

  /// DeformableDecoder::create
  std::unique_ptr<DeformableDecoder> (*decoder)(const Scene& scene, std::size_t object, const DecodeLimits& limits,
                                                std::unique_ptr<FollowedShape> shape);
};

extern const MeshSupport linked_mesh_support;

}  // namespace tactus
