// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/contact/surroundings.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tactus::sim {

// ==== constraints ====

namespace {

constexpr double kParallel = 1e-14;  // squared sine, or squared volume, below which normals count as dependent

class Search {
 public:
  Search(std::span<const Halfspace> planes, const Vec3& goal, double slack) : planes_(planes), goal_(goal), slack_(slack) {
    for (std::size_t i = 0; i < planes.size(); ++i) missing_[i] = planes[i].offset - dot(planes[i].normal, goal);
  }

  std::optional<Constrained> none() const { return accepted({goal_, {}}); }

  std::optional<Constrained> one(std::size_t i) const {
    if (missing_[i] < 0) return std::nullopt;
    Constrained out{goal_ + missing_[i] * n(i), {}};
    out.lambda[i] = missing_[i];
    return accepted(out);
  }

  std::optional<Constrained> two(std::size_t i, std::size_t j) const {
    const Vec3 axis = cross(n(i), n(j));
    const double sine2 = dot(axis, axis), cosine = dot(n(i), n(j));
    if (sine2 < kParallel) return std::nullopt;
    Constrained out;
    out.lambda[i] = (missing_[i] - cosine * missing_[j]) / sine2;
    out.lambda[j] = (missing_[j] - cosine * missing_[i]) / sine2;
    out.point = goal_ + (out.lambda[i] * n(i) + out.lambda[j] * n(j));
    return accepted(out);
  }

  std::optional<Constrained> three(std::size_t i, std::size_t j, std::size_t k) const {
    const Vec3 a = cross(n(j), n(k)), b = cross(n(k), n(i)), c = cross(n(i), n(j));
    const double volume = dot(n(i), a);
    if (volume * volume < kParallel) return std::nullopt;
    const Vec3 displacement = (1 / volume) * (missing_[i] * a + missing_[j] * b + missing_[k] * c);
    Constrained out{goal_ + displacement, {}};
    out.lambda[i] = dot(displacement, a) / volume;
    out.lambda[j] = dot(displacement, b) / volume;
    out.lambda[k] = dot(displacement, c) / volume;
    return accepted(out);
  }

 private:
  const Vec3& n(std::size_t i) const { return planes_[i].normal; }

  std::optional<Constrained> accepted(const Constrained& candidate) const {
    if (std::any_of(candidate.lambda.begin(), candidate.lambda.end(), [](double l) { return l < 0; })) return std::nullopt;
    for (const Halfspace& plane : planes_)
      if (dot(plane.normal, candidate.point) < plane.offset - slack_) return std::nullopt;
    return candidate;
  }

  std::span<const Halfspace> planes_;
  Vec3 goal_;
  double slack_;
  std::array<double, kMaxHalfspaces> missing_{};  // how far the goal lies below each plane
};

}  // namespace

double Constrained::sum() const noexcept { return std::accumulate(lambda.begin(), lambda.end(), 0.0); }

std::optional<Constrained> nearest_within(std::span<const Halfspace> planes, const Vec3& goal, double slack) noexcept {
  const Search search(planes, goal, slack);
  if (const auto found = search.none()) return found;
  for (std::size_t i = 0; i < planes.size(); ++i)
    if (const auto found = search.one(i)) return found;
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t j = i + 1; j < planes.size(); ++j)
      if (const auto found = search.two(i, j)) return found;
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t j = i + 1; j < planes.size(); ++j)
      for (std::size_t k = j + 1; k < planes.size(); ++k)
        if (const auto found = search.three(i, j, k)) return found;
  return std::nullopt;
}

// ==== surroundings ====

TriangleCache::Plane TriangleCache::plane_before(const Vec3& n, const Corners& v) noexcept {
  return {n.x, n.y, n.z, std::max({dot(n, v[0]), dot(n, v[1]), dot(n, v[2])})};
}

/// Whether both ends of the path, and thus all of it, are beyond contact with the triangle. Without a branch between the two.
bool TriangleCache::clears(const Plane& plane, const Sweep& sphere, double limit) noexcept {
  const double contact = sphere.radius + 0.5 * sphere.slack;
  const double start = plane.x * sphere.from.x + plane.y * sphere.from.y + plane.z * sphere.from.z - plane.offset;
  const double end =
      start + limit * (plane.x * sphere.displacement.x + plane.y * sphere.displacement.y + plane.z * sphere.displacement.z);
  return std::min(start, end) > contact;
}

/// Test a triangle, and remember the plane that its closest point gives.
std::optional<SurfaceHit> TriangleCache::ask(std::uint32_t number, const Sweep& sphere, double limit) noexcept {
  const AabbTree::Leaf& leaf = tree_.leaves_[number];
  const TriangleShape triangle(AabbTree::corners(leaf, vertices_));
  const TrianglePoint closest = closest_on_triangle(sphere.from, triangle);
  if (closest.distance2 > 0) {
    planes_[number % kKnown] = plane_before((1 / std::sqrt(closest.distance2)) * (sphere.from - closest.point), triangle.v);
    known_[number % kKnown] = number;
  }
  const auto hit = sphere_hits_triangle(sphere, triangle, limit, closest);
  if (!hit) return std::nullopt;
  return SurfaceHit{hit->t, hit->rest, AabbTree::named(leaf, hit->at.weights, hit->at.point, std::sqrt(hit->at.distance2))};
}

std::optional<SurfaceHit> TriangleCache::sweep_one(const Sweep& sphere, std::uint32_t triangle) noexcept {
  const std::uint32_t leaf = tree_.leaf_of_[triangle];
  if (knows(leaf) && clears(planes_[leaf % kKnown], sphere, 1)) return std::nullopt;
  return ask(leaf, sphere, 1);
}

/// Collect the triangles that the sphere may meet while it is within `reach` of `centre`.
/// out  false: there are too many
bool TriangleCache::collect(const Vec3& centre, double reach, const Sweep& sphere) noexcept {
  centre_ = centre;
  reach_ = reach;
  count_ = 0;
  return tree_.visit_boxes(centre, reach + sphere.radius + 2 * sphere.slack, [&](const AabbTree::Node& node) {
    if (count_ + node.count > kRoom) return false;
    const Vec3 away = AabbTree::away(node.box, centre);
    const double distance = norm(away);
    Plane before_box{0, 0, 0, HUGE_VAL};
    if (distance > 0) {
      const Vec3 n = (1 / distance) * away;
      before_box = {n.x, n.y, n.z, dot(n, centre - away)};
    }
    for (std::uint32_t leaf = node.next; leaf < node.next + node.count; ++leaf)
      candidates_[count_++] = {leaf, knows(leaf) ? planes_[leaf % kKnown] : before_box};
    return true;
  });
}

/// Fraction of the path that the cache covers.
double TriangleCache::covered(const Sweep& sphere) const noexcept {
  const double left = reach_ - norm(sphere.from - centre_);
  if (left >= 0 && norm(sphere.from + sphere.displacement - centre_) <= reach_) return 1;
  return std::min(left / norm(sphere.displacement), 1.0);
}

/// Rebuild the cache if it covers too little of the path. A short path is covered with a margin at both ends; of a long one only the
/// start, as it usually stops early.
/// out  fraction of the path that is covered, at most the limit
double TriangleCache::cover(const Sweep& sphere, double limit) noexcept {
  const double fraction = reach_ < 0 ? -1 : std::min(covered(sphere), limit), length = limit * norm(sphere.displacement);
  if (fraction == limit) return limit;
  if (length < 2 * wanted_reach_) {
    is_of_use_ = collect(sphere.from + (0.5 * limit) * sphere.displacement, 0.5 * (length + wanted_reach_), sphere);
    return limit;
  }
  if (fraction * norm(sphere.displacement) > 0.25 * wanted_reach_) return fraction;
  is_of_use_ = collect(sphere.from, wanted_reach_, sphere);
  return std::min(covered(sphere), limit);
}

/// Test the planes of all candidates in a loop without branches, then the closest points of the few that are left.
std::optional<SurfaceHit> TriangleCache::first_around(const Sweep& sphere, std::span<const std::uint32_t> left_out,
                                                      double limit) noexcept {
  std::array<std::uint32_t, kRoom> close;
  std::size_t close_count = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    close[close_count] = i;
    close_count += clears(candidates_[i].plane, sphere, limit) ? 0U : 1U;
  }
  std::optional<SurfaceHit> first;
  for (const std::uint32_t i : std::span(close).first(close_count)) {
    auto& [leaf, plane] = candidates_[i];
    if (first && clears(plane, sphere, limit)) continue;
    const std::uint32_t triangle = tree_.leaves_[leaf].triangle;
    if (std::find(left_out.begin(), left_out.end(), triangle) != left_out.end()) continue;
    if (!knows(leaf)) {  // a plane before the corners is tighter than one before the box
      plane = plane_before({plane.x, plane.y, plane.z}, AabbTree::corners(tree_.leaves_[leaf], vertices_));
      if (clears(plane, sphere, limit)) continue;
    }
    const auto hit = ask(leaf, sphere, limit);
    if (knows(leaf)) plane = planes_[leaf % kKnown];
    if (!hit || !earlier(*hit, first)) continue;
    first = hit;
    limit = hit->t;
    std::swap(candidates_[i], candidates_[0]);
  }
  return first;
}

std::optional<SurfaceHit> TriangleCache::sweep(const Sweep& sphere, std::span<const std::uint32_t> left_out,
                                               double limit) noexcept {
  const double fraction = is_of_use_ ? cover(sphere, limit) : 0;
  if (is_of_use_) {
    const auto first = first_around(sphere, left_out, fraction);
    if (first || fraction == limit) return first;
    is_of_use_ = false;
  }
  return tree_.sweep(sphere, vertices_, left_out);
}

}  // namespace tactus::sim
