// SPDX-License-Identifier: Apache-2.0
/// What collision detection asks of a single triangle.
///
/// A triangle is convex, so its distance f(t) from a point that moves along a line is a convex function of t. Newton's method on
/// f(t) = r therefore comes from the left and never passes the first contact of a moving sphere: no step is too long, however thin
/// the triangle or grazing the path.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <tactus/base/geometry.h>

namespace tactus::sim {

/// Corners of a triangle. The caller keeps their order: results have the same bits only for the same order.
using Corners = std::array<Vec3, 3>;

/// Point of a triangle that is closest to another point.
struct TrianglePoint {
  std::array<double, 3> weights{};  ///< of the corners, sum 1; exactly zero for corners that have no part in it
  Vec3 point;                       ///< [m]
  double distance2 = 0;             ///< [m^2]
};

/// A triangle with what all its closest points share.
struct TriangleShape {
  Corners v;
  Vec3 u, w, across, normal;  ///< edges 0-1, 0-2, 1-2; u x w
  double u2, w2, across2, area2;

  explicit TriangleShape(const Corners& corners) noexcept
      : v(corners),
        u(v[1] - v[0]),
        w(v[2] - v[0]),
        across(v[2] - v[1]),
        normal(cross(u, w)),
        u2(dot(u, u)),
        w2(dot(w, w)),
        across2(dot(across, across)),
        area2(dot(normal, normal)) {}
};

/// Needles whose height is below 1e-10 of their length are treated as their edges.
/// Inlined: a call would add a tenth to the time of every contact, for handing over results.
[[gnu::always_inline]] inline TrianglePoint closest_on_triangle(const Vec3& p, const TriangleShape& s) noexcept {
  const Vec3 q = p - s.v[0];
  const double longest2 = std::max(s.u2, s.w2);
  std::array<double, 3> weight{-1, -1, -1};
  if (s.area2 > 1e-20 * longest2 * longest2) {
    weight[1] = dot(cross(q, s.w), s.normal) / s.area2;
    weight[2] = dot(cross(s.u, q), s.normal) / s.area2;
    weight[0] = 1 - weight[1] - weight[2];
    if (weight[0] >= 0 && weight[1] >= 0 && weight[2] >= 0) {
      const Vec3 point = s.v[0] + (weight[1] * s.u + weight[2] * s.w);
      return {weight, point, dot(p - point, p - point)};
    }
  }
  // The closest point lies on an edge that can be seen from p.
  TrianglePoint best;
  best.distance2 = HUGE_VAL;
  double fraction = 0;
  std::size_t start = 0, end = 0;
  const auto try_edge = [&](std::size_t i, std::size_t j, const Vec3& from_start, const Vec3& edge, double length2) {
    const double along = dot(from_start, edge) / length2, positive = along > 0 ? along : 0, part = positive < 1 ? positive : 1;
    const Vec3 point = part == 1 ? s.v[j] : s.v[i] + part * edge, away = p - point;
    const double distance2 = dot(away, away);
    if (!(distance2 < best.distance2)) return;
    best.distance2 = distance2;
    best.point = point;
    fraction = part;
    start = i;
    end = j;
  };
  if (weight[0] < 0) try_edge(1, 2, p - s.v[1], s.across, s.across2);
  if (weight[1] < 0) try_edge(0, 2, q, s.w, s.w2);
  if (weight[2] < 0) try_edge(0, 1, q, s.u, s.u2);
  best.weights[start] = 1 - fraction;
  best.weights[end] = fraction;
  return best;
}
inline TrianglePoint closest_on_triangle(const Vec3& p, const Corners& v) noexcept {
  return closest_on_triangle(p, TriangleShape(v));
}

/// A moving sphere.
struct Sweep {
  Vec3 from, displacement;  ///< [m] start of the centre, and its displacement
  double radius = 0;        ///< [m] > 0
  double slack = 0;         ///< [m] > 0: distance from contact at which it is to come to rest
};

/// Where a moving sphere first touches a triangle.
struct TriangleTouch {
  double t = 0;  ///< fraction of the path, 0..1, of the contact; up to there the distance is never below the radius
  double rest =
      0;  ///< fraction of the path, 0..t, up to which the distance is at least radius + slack (0: it is not even at the start)
  TrianglePoint at;  ///< point touched
};

/// A sphere that touches at the start, or reaches into the triangle, is stopped when it would come closer, and free to leave.
/// in  limit    later contacts are ignored
///     closest  point of the triangle to the start of the path
/// time one closest point if far or moving away, a few for a contact; after at most 32 the sphere stops short of contact
[[gnu::always_inline]] inline std::optional<TriangleTouch> sphere_hits_triangle(const Sweep& sweep, const TriangleShape& triangle,
                                                                                double limit,
                                                                                const TrianglePoint& closest) noexcept {
  constexpr int kMaxSteps = 32;
  constexpr double kContact = 0x1p-20;  // of the slack
  TriangleTouch touch{0, 0, closest};
  double slope = 0;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double distance = std::sqrt(touch.at.distance2), gap = distance - sweep.radius;
    const bool contact = gap <= kContact * sweep.slack;
    if (contact && step > 0) break;
    const Vec3 away = sweep.from + touch.t * sweep.displacement - touch.at.point;
    slope = distance > 0 ? dot(away, sweep.displacement) / distance : -norm(sweep.displacement);
    if (!(slope < 0) || touch.t - gap / slope > limit) return std::nullopt;
    if (contact) break;
    touch.t -= gap / slope;
    touch.at = closest_on_triangle(sweep.from + touch.t * sweep.displacement, triangle);
  }
  touch.rest = std::fmax(0.0, touch.t + sweep.slack / slope);  // the last tangent lies below f here, too
  return touch;
}
inline std::optional<TriangleTouch> sphere_hits_triangle(const Sweep& sweep, const Corners& v, double limit) noexcept {
  const TriangleShape shape(v);
  return sphere_hits_triangle(sweep, shape, limit, closest_on_triangle(sweep.from, shape));
}

}  // namespace tactus::sim
