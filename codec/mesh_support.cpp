// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/mesh_support.h>

#include <tactus/deformable/deformable_decoder.h>
#include <tactus/mesh/basis.h>
#include <tactus/mesh/graph.h>
#include <tactus/scene/elastic_syntax.h>
#include <tactus/scene/scene_rules.h>

namespace tactus {
namespace {

void compute_basis(DeformableObject& object) {
  if (object.spring_basis.modes > 0) object.basis = spring_basis(object);
  if (object.cluster_basis.count > 0) object.basis = cluster_basis(object);
}

std::shared_ptr<const VertexHierarchy> hierarchy(const DeformableObject& object) {
  return std::make_shared<const VertexHierarchy>(vertex_hierarchy(object));
}

}  // namespace

const MeshSupport linked_mesh_support{.broken_rule = broken_deformable_rule,
                                      .is_solid = is_solid,
                                      .steps_stably = steps_stably,
                                      .elastic_work = elastic_work,
                                      .compute_basis = compute_basis,
                                      .hierarchy = hierarchy,
                                      .decoder = DeformableDecoder::create};

}  // namespace tactus
