// SPDX-License-Identifier: Apache-2.0
/// What is declared to a client of a deformable object, so that it can compute what its own device does to it. spec/55-elastic.md
#pragma once

#include <optional>

#include <tactus/scene/scene_builder.h>
#include <tactus/sim/scene/scene.h>

namespace tactus::sim {

/// How a client steps an object.
struct ElasticStep {
  ElasticBody::Method method = ElasticBody::Method::tr_bdf2;
  int sub_steps = 1;  ///< of velocity Verlet, at least; more where what is declared is stiffer than the truth
};

/// in   step  the method that the server takes itself, or comes nearest to it
///      model_scale  times the true Young's modulus; 0: nothing is declared
/// out  nothing: none is to be declared, its elements do not turn, it has more than 255 materials, or it is too much for a client.
std::optional<ElasticPhysics> elastic_physics(const SceneDeformable& object, const Vec3& gravity, const ElasticStep& step,
                                              double model_scale = 1);

}  // namespace tactus::sim
