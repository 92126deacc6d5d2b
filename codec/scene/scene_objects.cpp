// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/scene_objects.h>

#include <cmath>

#include <tactus/base/quantise.h>
#include <tactus/base/rule.h>

namespace tactus {

Result<RigidPose> to_grid(const Pose& pose, unsigned position_exp) noexcept {
  Result<RigidPose> out;
  if (const RuleName rule = quantise(pose, position_exp, out->position, out->rotation)) return fail(Errc::invalid_argument, rule);
  return out;
}

Pose to_pose(const RigidPose& pose, unsigned position_exp) noexcept {
  const double metre = 1.0 / static_cast<double>(std::uint64_t{1} << position_exp);
  double q[4];
  double square = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    q[i] = pose.rotation[i];
    square += q[i] * q[i];
  }
  const double length = std::sqrt(square);
  return {{pose.position[0] * metre, pose.position[1] * metre, pose.position[2] * metre},
          {q[0] / length, q[1] / length, q[2] / length, q[3] / length}};
}

}  // namespace tactus
