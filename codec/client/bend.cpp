// SPDX-License-Identifier: Apache-2.0
#include <tactus/client/bend.h>

#include <tactus/base/fixed.h>
#include <tactus/rigid/curve.h>

namespace tactus {

RigidPose bend(const Scene& scene, const RigidState& a, const RigidState& b, std::int64_t tick) noexcept {
  const RigidPredictor predictor(scene);
  const std::int64_t whole = b.tick - a.tick;
  const std::int64_t share = round_div((tick - a.tick) << 30, whole);
  const Cubic curve = cubic(share);
  const bool is_moving = !is_zero(a.velocity) || !is_zero(b.velocity);
  const bool is_turning = !is_zero(a.angular_velocity) || !is_zero(b.angular_velocity);
  const PoseOffset error = offset_between(predictor.pose(a, b.tick), {b.position, b.rotation});
  const PoseOffset change = change_between(scene, predictor.motion(a, b.tick, {}), {b.velocity, b.angular_velocity}, whole);
  return displaced(predictor.pose(a, tick), error, change,
                   {is_moving ? curve.error : share, is_turning ? curve.error : share, curve.change});
}

}  // namespace tactus
