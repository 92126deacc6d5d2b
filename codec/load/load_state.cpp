// SPDX-License-Identifier: Apache-2.0
#include <tactus/load/load_state.h>

#include <cmath>

#include <tactus/base/bytes.h>
#include <tactus/base/quantise.h>
#include <tactus/base/rule.h>

namespace tactus {

LoadState initial_loads(const Scene& scene) {
  return {.tick = 0, .vectors = std::vector<GridForce>(scene.moving().size() * vectors_of_load(scene))};
}

Result<GridForce> to_grid_force(const Vec3& force, unsigned force_exp) noexcept {
  if (!is_finite(force)) return fail(Errc::invalid_argument, "R-API-1");
  constexpr double kMost = 2147483647.0;
  GridForce out{};
  if (!quantise(force.x, force_exp, kMost, out[0]) || !quantise(force.y, force_exp, kMost, out[1]) ||
      !quantise(force.z, force_exp, kMost, out[2]))
    return fail(Errc::invalid_argument, "R-API-2");
  return out;
}

Vec3 to_force(const GridForce& force, unsigned force_exp) noexcept {
  const auto newtons = [force_exp](std::int32_t v) { return std::ldexp(static_cast<double>(v), -static_cast<int>(force_exp)); };
  return {newtons(force[0]), newtons(force[1]), newtons(force[2])};
}

std::uint64_t state_hash(const LoadState& state) noexcept {
  Fnv1a hash;
  hash.add64(static_cast<std::uint64_t>(state.tick));
  for (const GridForce& vector : state.vectors)
    for (const std::int32_t c : vector) hash.add32(c);
  return hash.value();
}

}  // namespace tactus
