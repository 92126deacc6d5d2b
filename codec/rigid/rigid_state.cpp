// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_state.h>

#include <algorithm>

#include <tactus/base/bytes.h>
#include <tactus/base/fixed.h>
#include <tactus/base/quantise.h>
#include <tactus/base/rule.h>
#include <tactus/rigid/rigid_states.h>

namespace tactus {
RigidStates initial_states(const Scene& scene) {
  const std::size_t copies = std::max<std::size_t>(2, scene.baseline_span) + 1;
  return {.tick = 0, .objects = PagedArray<RigidState>(scene.objects.size(), copies, [&scene](std::size_t i) {
                       return initial_state(scene, i);
                     })};
}

Result<RigidState> to_grid(const RigidSample& sample, std::int64_t tick, const GridExponents& grid) noexcept {
  if (!is_finite(sample.velocity) || !is_finite(sample.angular_velocity)) return fail(Errc::invalid_argument, "R-API-1");
  Result<RigidState> state;  // filled in place
  state->tick = tick;
  if (const RuleName rule = quantise(sample.pose, grid.position, state->position, state->rotation))
    return fail(Errc::invalid_argument, rule);
  const auto vector = [](const Vec3& v, unsigned exp, double limit, Vec3i& out) {
    return quantise(v.x, exp, limit, out[0]) && quantise(v.y, exp, limit, out[1]) && quantise(v.z, exp, limit, out[2]);
  };
  if (!vector(sample.velocity, grid.velocity, 2147483647.0, state->velocity) ||
      !vector(sample.angular_velocity, grid.angular_velocity, kAngularVelocityLimit, state->angular_velocity)) {
    return fail(Errc::invalid_argument, "R-API-2");
  }
  return state;
}

std::uint64_t state_hash(const Scene& scene, const RigidStates& states) noexcept {
  Fnv1a hash;
  for (const std::uint32_t i : scene.moving()) {
    const RigidState& s = states.objects[i];
    hash.add64(static_cast<std::uint64_t>(s.tick));
    for (const std::int32_t v : s.position) hash.add32(v);
    for (const std::int32_t v : s.rotation) hash.add32(v);
    for (const std::int32_t v : s.velocity) hash.add32(v);
    for (const std::int32_t v : s.angular_velocity) hash.add32(v);
    if (scene.is_smoothed) hash.add32(s.smoothing_exp + 8 * s.retained);
    if (scene.motion || scene.driven) hash.add32(static_cast<std::int32_t>(s.predictor));
    if (scene.driven) {
      hash.add32(s.contact.is_held ? 1 : 0);
      for (const std::int32_t v : s.contact.point) hash.add32(v);
      for (const std::int32_t v : s.contact.normal) hash.add32(v);
      hash.add32(s.contact.drag);
    }
    if (scene.interest) hash.add32(s.lod);
  }
  return hash.value();
}

}  // namespace tactus
