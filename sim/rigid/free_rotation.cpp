// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/rigid/free_rotation.h>

#include <cmath>

namespace tactus::sim {
namespace {

constexpr double kLargestTurn = 0.1;               // [rad] of a step of fourth order
constexpr double kOuter = 0.41449077179437573714;  // 1 / (4 - 4^(1/3))
constexpr double kWeights[] = {kOuter, kOuter, 1 - 4 * kOuter, kOuter, kOuter};
constexpr int kMostIterations = 40;  // each gains a digit or more

/// y_m of a step, by fixed-point iteration to the last bit, or nearly.
Vec3 middle(const Vec3& momentum, const Inertia& inertia, double half) noexcept {
  if (inertia.is_spherical) return momentum;
  Vec3 out = momentum;
  for (int i = 0; i < kMostIterations; ++i) {
    const Vec3 next = momentum + half * cross(out, inertia.inverse * out);
    if (next == out) break;
    out = next;
  }
  return out;
}

/// R cay(2 v)
Quat turned(const Quat& rotation, const Vec3& v) noexcept {
  const double scale = 1 / std::sqrt(1 + dot(v, v));
  return rotation * Quat{scale, scale * v.x, scale * v.y, scale * v.z};
}

Quat normalised(const Quat& q) noexcept {
  const double scale = 1 / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {scale * q.w, scale * q.x, scale * q.y, scale * q.z};
}

}  // namespace

Turning turn_freely(const Turning& now, const Inertia& inertia, double seconds) noexcept {
  const Quat start = normalised(now.rotation);
  const Vec3 momentum = rotate(start, inertia.moments * rotate(conjugate(start), now.angular_velocity));
  const double steps = std::floor(norm(now.angular_velocity) * seconds / kLargestTurn) + 1;
  Quat rotation = start;
  for (int i = 0; i < static_cast<int>(steps); ++i) {
    for (const double weight : kWeights) {
      const double half = weight * seconds / steps / 2;
      const Vec3 mean = middle(rotate(conjugate(rotation), momentum), inertia, half);
      rotation = turned(rotation, half * (inertia.inverse * mean));
    }
    rotation = normalised(rotation);
  }
  return {rotation, rotate(rotation, inertia.inverse * rotate(conjugate(rotation), momentum))};
}

}  // namespace tactus::sim
