// SPDX-License-Identifier: Apache-2.0
/// What a client is told of a deformable object, so that it can work out what its own device does to it. spec/55-elastic.md
#pragma once

#include <optional>

#include <tactus/scene/scene_builder.h>
#include <tactus/sim/scene/scene.h>

namespace tactus::sim {

/// How a client steps an object.
struct ElasticStep {
  ElasticBody::Method method = ElasticBody::Method::tr_bdf2;
  int sub_steps = 1;  ///< of velocity Verlet, at least; more where what is told is stiffer than the truth
};

/// in   step  the method that the server takes itself, or comes nearest to it
///      told  times the true Young's modulus; 0: nothing is told
/// out  nothing: as told, its elements do not turn, it has more than 255 materials, or it is too much for a client.
std::optional<ElasticPhysics> elastic_physics(const SceneDeformable& object, const Vec3& gravity, const ElasticStep& step,
                                              double told = 1);

}  // namespace tactus::sim
