// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/geometry.h>

#include <cmath>

#include <tactus/base/elementary.h>

namespace tactus {

double norm(const Vec3& a) noexcept { return std::sqrt(dot(a, a)); }

double angle_between(const Quat& a, const Quat& b) noexcept {
  const Quat d = b * conjugate(a);
  return 2.0 * angle_of(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), std::abs(d.w));
}

}  // namespace tactus
