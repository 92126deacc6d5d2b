// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/rigid_object.h>

#include <algorithm>
#include <cmath>

#include <tactus/base/fixed.h>
#include <tactus/base/quantise.h>

namespace tactus {

Result<RigidPose> to_grid(const Pose& pose, unsigned position_exp) noexcept {
  const Quat& q = pose.rotation;
  if (!is_finite(pose.position) || !is_finite(q)) return fail(Errc::invalid_argument, "R-API-1");
  RigidPose out;
  constexpr double kLimit = 2147483647.0;
  const double position[] = {pose.position.x, pose.position.y, pose.position.z};
  for (std::size_t i = 0; i < 3; ++i)
    if (!quantise(position[i], position_exp, kLimit, out.position[i])) return fail(Errc::invalid_argument, "R-API-2");
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!(std::abs(length - 1) <= 1e-3)) return fail(Errc::invalid_argument, "R-API-3");
  const double scale = static_cast<double>(kOne30) / length;
  const double components[] = {q.w, q.x, q.y, q.z};
  for (std::size_t i = 0; i < 4; ++i)
    out.rotation[i] = static_cast<std::int32_t>(std::min(std::floor(components[i] * scale + 0.5), static_cast<double>(kOne30)));
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
