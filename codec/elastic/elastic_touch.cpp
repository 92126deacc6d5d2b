// SPDX-License-Identifier: Apache-2.0
#include <tactus/elastic/elastic_touch.h>

#include <cmath>
#include <vector>

namespace tactus {
namespace {

constexpr int kMostSteps = 64;  // from triangle to triangle

Vec3 blend(const std::array<double, 3>& w, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  return {w[0] * a.x + w[1] * b.x + w[2] * c.x, w[0] * a.y + w[1] * b.y + w[2] * c.y, w[0] * a.z + w[1] * b.z + w[2] * c.z};
}

/// Weights of the point of a triangle that is nearest to p, by the region of its plane in which p lies (Ericson 2005, 5.1.5).
std::array<double, 3> nearest_weights(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double a1 = dot(ab, ap), a2 = dot(ac, ap);
  if (a1 <= 0 && a2 <= 0) return {1, 0, 0};
  const double b1 = dot(ab, bp), b2 = dot(ac, bp);
  if (b1 >= 0 && b2 <= b1) return {0, 1, 0};
  const double in_c = a1 * b2 - b1 * a2;
  if (in_c <= 0 && a1 >= 0 && b1 <= 0) {
    const double w = a1 / (a1 - b1);
    return {1 - w, w, 0};
  }
  const double c1 = dot(ab, cp), c2 = dot(ac, cp);
  if (c2 >= 0 && c1 <= c2) return {0, 0, 1};
  const double in_b = c1 * a2 - a1 * c2;
  if (in_b <= 0 && a2 >= 0 && c2 <= 0) {
    const double w = a2 / (a2 - c2);
    return {1 - w, 0, w};
  }
  const double in_a = b1 * c2 - c1 * b2;
  if (in_a <= 0 && b2 - b1 >= 0 && c1 - c2 >= 0) {
    const double w = (b2 - b1) / ((b2 - b1) + (c1 - c2));
    return {0, 1 - w, w};
  }
  const double all = in_a + in_b + in_c, v = in_b / all, w = in_c / all;
  return {1 - v - w, v, w};
}

}  // namespace

ElasticTouch::ElasticTouch(const DeformableObject& object) : object_(object) {
  std::vector<std::vector<std::uint32_t>> of(object.rest.size());
  for (std::uint32_t t = 0; t < object.triangles.size(); ++t)
    for (const std::uint32_t v : object.triangles[t]) of[v].push_back(t);
  for (const auto& list : of) {
    triangles_of_.items.insert(triangles_of_.items.end(), list.begin(), list.end());
    triangles_of_.close();
  }
}

ElasticTouch::Foot ElasticTouch::foot(const Vec3& position, std::uint32_t triangle,
                                      std::span<const Vec3> vertices) const noexcept {
  const auto& [i, j, k] = object_.triangles[triangle];
  Foot out{.triangle = triangle, .weights = nearest_weights(position, vertices[i], vertices[j], vertices[k]), .point = {}};
  out.point = blend(out.weights, vertices[i], vertices[j], vertices[k]);
  const Vec3 away = position - out.point;
  out.distance2 = dot(away, away);
  return out;
}

ElasticTouch::Foot ElasticTouch::nearest(const Vec3& position, std::span<const Vec3> vertices) const noexcept {
  Foot best = foot(position, 0, vertices);
  for (std::uint32_t t = 1; t < object_.triangles.size(); ++t)
    if (const Foot other = foot(position, t, vertices); other.distance2 < best.distance2 || std::isnan(best.distance2))
      best = other;
  return best;
}

/// The triangle has every corner that counts in the foot.
bool ElasticTouch::meets(std::uint32_t triangle, const Foot& foot) const noexcept {
  const Triangle &own = object_.triangles[foot.triangle], &other = object_.triangles[triangle];
  for (std::size_t r = 0; r < 3; ++r)
    if (foot.weights[r] != 0 && own[r] != other[0] && own[r] != other[1] && own[r] != other[2]) return false;
  return true;
}

/// From triangle to triangle, each time to one that holds the foot, as long as that leads nearer.
ElasticTouch::Foot ElasticTouch::descend(const Vec3& position, std::uint32_t triangle,
                                         std::span<const Vec3> vertices) const noexcept {
  Foot at = foot(position, triangle, vertices);
  for (int i = 0; i < kMostSteps; ++i) {
    Foot best = at;
    std::size_t corner = 0;
    while (corner < 2 && at.weights[corner] == 0) ++corner;
    for (const std::uint32_t t : triangles_of_[object_.triangles[at.triangle][corner]]) {
      if (t == at.triangle || !meets(t, at)) continue;
      if (const Foot other = foot(position, t, vertices); other.distance2 < best.distance2) best = other;
    }
    if (best.triangle == at.triangle) break;
    at = best;
  }
  return at;
}

bool ElasticTouch::is_inside(const Vec3& position, const Foot& foot, std::span<const Vec3> vertices) const noexcept {
  const auto& [a, b, c] = object_.triangles[foot.triangle];
  return dot(position - foot.point, cross(vertices[b] - vertices[a], vertices[c] - vertices[a])) < 0;
}

/// Where the path of the device met the surface, given its foot after.
ElasticTouch::Foot ElasticTouch::met(const Vec3& position, const Foot& foot, std::span<const Vec3> vertices,
                                     const State& state) const noexcept {
  if (!state.last) return foot;
  const auto& [i, j, k] = object_.triangles[foot.triangle];
  const Vec3 n = cross(vertices[j] - vertices[i], vertices[k] - vertices[i]);
  const double over = dot(*state.last - vertices[i], n), under = dot(position - vertices[i], n);
  if (!(over > 0)) return foot;
  return descend(*state.last + (over / (over - under)) * (position - *state.last), foot.triangle, vertices);
}

/// Where friction holds the proxy: Coulomb's cone over the plane of the triangle that held it.
ElasticTouch::Foot ElasticTouch::hold(const Vec3& position, std::span<const Vec3> vertices, const State& state) const noexcept {
  const auto& [i, j, k] = object_.triangles[*state.triangle];
  const Vec3 &a = vertices[i], &b = vertices[j], &c = vertices[k];
  const Foot held{.triangle = *state.triangle, .weights = state.weights, .point = blend(state.weights, a, b, c)};
  const Vec3 n = cross(b - a, c - a), base = position - (dot(position - held.point, n) / dot(n, n)) * n;
  const Vec3 lag = held.point - base;
  const double far = norm(lag), rim = object_.body->friction * norm(position - base);
  if (far <= rim) return held;
  return descend(base + (rim / far) * lag, held.triangle, vertices);
}

std::optional<ElasticTouch::Push> ElasticTouch::move(const Vec3& position, bool anew, std::span<const Vec3> vertices,
                                                     State& state) const noexcept {
  if (object_.triangles.empty()) return std::nullopt;
  const bool touched = state.touches;
  Foot at = descend(position, state.triangle ? *state.triangle : nearest(position, vertices).triangle, vertices);
  state.touches = is_inside(position, at, vertices);
  if (anew && !touched && !state.touches && state.triangle) {
    at = descend(position, nearest(position, vertices).triangle, vertices);
    state.touches = is_inside(position, at, vertices);
  }
  if (state.touches && object_.body->friction > 0) {
    if (!touched) {
      const Foot first = met(position, at, vertices, state);
      state.triangle = first.triangle;
      state.weights = first.weights;
    }
    at = hold(position, vertices, state);
  }
  state.triangle = at.triangle;
  state.weights = at.weights;
  state.last = position;
  if (!state.touches) return std::nullopt;
  return Push{at.triangle, at.weights, object_.body->coupling * (position - at.point)};
}

}  // namespace tactus
