// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/contact/mesh_proxy.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace tactus::sim {
namespace {

constexpr int kMaxSweeps = 16;
constexpr int kMaxPushes = 4;
constexpr int kConfirmations = 2;  // searches without progress that settle it, when several planes hold
constexpr int kMaxIdle = 4;        // searches that move the proxy only by rounding
constexpr double kExpected = 0.6;  // of the distance kept: how far the proxy may well go in a call, even if the probe rests

Corners corners_of(const Triangle& triangle, std::span<const Vec3> vertices) {
  return {vertices[triangle[0]], vertices[triangle[1]], vertices[triangle[2]]};
}

Vec3 blend(const std::array<double, 3>& weights, const Corners& v) {
  return weights[0] * v[0] + weights[1] * v[1] + weights[2] * v[2];
}

/// Axes of a triangle: along its first edge, across it, along its normal.
std::optional<std::array<Vec3, 3>> axes(const Corners& v) {
  const Vec3 edge = v[1] - v[0], normal = cross(edge, v[2] - v[0]);
  const double length = norm(edge), area = norm(normal);
  if (!(length > 0 && area > 0)) return std::nullopt;
  const Vec3 x = (1 / length) * edge, z = (1 / area) * normal;
  return std::array<Vec3, 3>{x, cross(z, x), z};
}

/// Unit vector from a point of the surface to the sphere's centre. On a face it is the plane's normal, exact at any distance.
Vec3 away_from(const SurfacePoint& at, const Vec3& centre, std::span<const Vec3> vertices, const AabbTree& tree) {
  const Vec3 away = centre - at.point;
  if (at.feature() == Feature::face) {
    const Corners v = corners_of(tree.triangle(at.triangle), vertices);
    const Vec3 normal = cross(v[1] - v[0], v[2] - v[0]);
    return std::copysign(1 / norm(normal), dot(normal, away)) * normal;
  }
  const double length = norm(away);
  return length > 0 ? (1 / length) * away : Vec3{0, 0, 1};
}

}  // namespace

MeshProxy::MeshProxy(const MeshProxyOptions& options, double extent) noexcept
    : options_(options),
      skin_(0x1p-24 * std::fmax(extent, options.radius)),
      slack_(skin_ / 8),
      settled_(std::fmax(slack_, 0x1p-14 * options.radius)) {}

Sweep MeshProxy::towards(const Vec3& goal) const noexcept { return {centre_, goal - centre_, distance(), slack_}; }

/// Motion below the slack is ignored, so that a held proxy does not creep.
bool MeshProxy::lets_move(const SurfaceHit& hit, const Vec3& displacement) const noexcept {
  return hit.rest * norm(displacement) > slack_;
}

/// Test the triangles that held the proxy last first. One that allows no motion decides, unless a point meets it at an edge: the face
/// beside the edge may be what carries the point.
std::optional<SurfaceHit> MeshProxy::first_contact(const Vec3& goal, const AabbTree& tree, TriangleCache& around) const noexcept {
  const Sweep sweep = towards(goal);
  std::array<std::uint32_t, kMaxHalfspaces + std::tuple_size_v<decltype(recent_)>> asked;
  const auto held_end = std::copy_n(held_by_.begin(), held_, asked.begin());
  auto asked_end = held_end;
  std::optional<SurfaceHit> first;
  for (const std::uint32_t triangle : recent_) {
    if (!tree.contains(triangle) || std::find(asked.begin(), held_end, triangle) != held_end) continue;
    *asked_end++ = triangle;
    const auto hit = around.sweep_one(sweep, triangle);
    if (!hit) continue;
    if (!lets_move(*hit, sweep.displacement) && (hit->at.feature() == Feature::face || options_.radius > 0)) return hit;
    if (earlier(*hit, first)) first = hit;
  }
  const auto hit = around.sweep(sweep, std::span(asked.begin(), asked_end), first ? first->t : 1);
  return hit && earlier(*hit, first) ? hit : first;
}

/// Add a plane. If there is no room, drop the planes that do not press, or else the oldest one.
void MeshProxy::hold(const Plane& plane) noexcept {
  if (held_ == kMaxHalfspaces) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < held_; ++i)
      if (depth_[i] > 0) planes_[kept++] = planes_[i];
    if (kept == held_) std::move(planes_.begin() + 1, planes_.begin() + static_cast<std::ptrdiff_t>(kept--), planes_.begin());
    held_ = kept;
    for (std::size_t i = 0; i < held_; ++i) held_by_[i] = planes_[i].at.triangle;
  }
  planes_[held_] = plane;
  held_by_[held_++] = plane.at.triangle;
  const auto known = std::find(recent_.begin(), recent_.end() - 1, plane.at.triangle);
  std::rotate(recent_.begin(), known, known + 1);
  recent_.front() = plane.at.triangle;
}

void MeshProxy::release() noexcept {
  held_ = 0;
  depth_.fill(0);
}

/// The proxy's goal: as near to the probe as its planes and friction permit.
std::optional<Vec3> MeshProxy::wanted(const Vec3& probe) noexcept {
  if (held_ == 0) return probe;
  std::array<Halfspace, kMaxHalfspaces> planes;  // relative to the proxy, where rounding is smallest
  for (std::size_t i = 0; i < held_; ++i) {
    const Plane& plane = planes_[i];
    planes[i] = {plane.normal, dot(plane.normal, plane.at.point - centre_) + (distance() + slack_)};
  }
  const auto nearest = nearest_within({planes.data(), held_}, probe - centre_, slack_ / 4);
  if (!nearest) return std::nullopt;
  depth_ = nearest->lambda;
  const double lag = norm(nearest->point), rim = options_.friction * nearest->sum();
  if (lag <= rim) return centre_;
  return centre_ + (1 - rim / lag) * nearest->point;
}

void MeshProxy::follow(const Vec3& probe, std::span<const Vec3> vertices, const AabbTree& tree) noexcept {
  release();
  TriangleCache around(tree, vertices, std::fmax(norm(probe - probe_), kExpected * distance()));
  bool moved = false;  // since the planes were last released
  int idle = 0;        // how often in a row they were released without progress
  double reached = norm(probe - centre_);
  for (int sweeps = 0; sweeps < kMaxSweeps;) {
    const auto goal = wanted(probe);
    if (!goal) {  // two planes are almost parallel: the one met last decides
      const Plane last = planes_[held_ - 1];
      release();
      hold(last);
      ++sweeps;
      continue;
    }
    const bool settled = held_ > 0 && norm(*goal - centre_) <= settled_;
    if (!settled) {
      const Vec3 from = centre_, displacement = *goal - centre_;
      const auto hit = first_contact(*goal, tree, around);
      ++sweeps;
      if (!hit) centre_ = *goal;
      else if (lets_move(*hit, displacement)) centre_ = from + hit->rest * displacement;
      moved = moved || centre_ != from;
      if (hit) {
        hold({hit->at, away_from(hit->at, from + hit->t * displacement, vertices, tree)});
        continue;
      }
      if (held_ == 0) return;
    }
    // A single plane that allows no motion is certain. Among several, one met at an edge may have hidden a possible motion.
    const double remaining = norm(probe - centre_);
    idle = remaining < reached - slack_ ? 0 : idle + 1;
    if ((settled && !moved && (held_ == 1 || idle >= kConfirmations)) || idle > kMaxIdle || sweeps >= kMaxSweeps) return;
    reached = std::fmin(reached, remaining);
    release();
    moved = false;
  }
}

/// Move and turn the proxy along with its anchor's triangle.
void MeshProxy::carry(std::span<const Vec3> vertices, const AabbTree& tree) noexcept {
  if (!tree.contains(anchor_.triangle)) return;
  const Corners now = corners_of(tree.triangle(anchor_.triangle), vertices);
  if (now == anchor_.corners) return;
  const auto old_axes = axes(anchor_.corners), new_axes = axes(now);
  Vec3 offset = centre_ - blend(anchor_.weights, anchor_.corners);
  if (old_axes && new_axes) {
    const Vec3 local{dot(offset, (*old_axes)[0]), dot(offset, (*old_axes)[1]), dot(offset, (*old_axes)[2])};
    offset = local.x * (*new_axes)[0] + local.y * (*new_axes)[1] + local.z * (*new_axes)[2];
  }
  const Vec3 foot = blend(anchor_.weights, now);
  anchor_.corners = now;
  centre_ = foot + offset;
  if (const double height = norm(offset), least = distance() + slack_; height > 2 * least) {  // others may lie in between
    centre_ = foot + (least / height) * offset;
    const auto hit = tree.sweep(towards(foot + offset), vertices, {&anchor_.triangle, 1});
    centre_ = hit ? centre_ + hit->rest * (foot + offset - centre_) : foot + offset;
  }
  keep_distance(vertices, tree);
}

/// A triangle may pass over the proxy if its closest point comes nearer by at least half of the distance. The other half allows for
/// the triangle's rotation.
void MeshProxy::expect(double reach, std::span<const Vec3> vertices, std::span<const Vec3> next, const AabbTree& tree) noexcept {
  if (!placed_ || held_ > 0) return;
  double farthest = 0;
  anchor_ = {};
  tree.visit_sphere(centre_, 2 * reach + distance() + slack_, vertices, [&](std::uint32_t triangle, const Corners&) {
    const Triangle corners = tree.triangle(triangle);
    const Corners now = corners_of(corners, vertices);
    const TrianglePoint at = closest_on_triangle(centre_, now);
    const Vec3 away = centre_ - at.point, moves = blend(at.weights, corners_of(corners, next)) - at.point;
    const double far = norm(away), nearer = far > 0 ? dot(moves, away) / far : norm(moves), past = nearer - far;
    if (!(nearer > 0 && nearer >= 0.5 * far)) return;
    const bool is_first = anchor_.triangle == MeshTopology::kNone;
    if (!is_first && (past < farthest || (past == farthest && triangle > anchor_.triangle))) return;
    farthest = past;
    anchor_ = {triangle, at.weights, now};
  });
}

/// Step back from triangles that are closer than the distance kept.
void MeshProxy::keep_distance(std::span<const Vec3> vertices, const AabbTree& tree) noexcept {
  for (int push = 0; push < kMaxPushes; ++push) {
    const auto nearest = tree.closest(centre_, vertices, distance() - slack_);
    if (!nearest) return;
    const Vec3 goal = centre_ + (distance() + slack_ - nearest->distance) * away_from(*nearest, centre_, vertices, tree);
    const auto hit = tree.sweep(towards(goal), vertices, {&nearest->triangle, 1});
    centre_ = hit ? centre_ + hit->rest * (goal - centre_) : goal;
  }
}

ProxyTouch MeshProxy::settle(const Vec3& probe, std::span<const Vec3> vertices, const AabbTree& tree) noexcept {
  follow(probe, vertices, tree);
  ProxyTouch touch{.proxy = centre_};
  anchor_ = {};
  if (held_ > 0) {
    Vec3 normal;
    std::size_t firmest = 0;
    for (std::size_t i = 0; i < held_; ++i) {
      normal = normal + depth_[i] * planes_[i].normal;
      if (depth_[i] > depth_[firmest]) firmest = i;
    }
    const double length = norm(normal);
    touch.touched = true;
    touch.triangle = planes_[firmest].at.triangle;
    touch.weights = planes_[firmest].at.weights;
    touch.normal = length > 0 ? (1 / length) * normal : planes_[firmest].normal;
    anchor_ = {touch.triangle, touch.weights, corners_of(tree.triangle(touch.triangle), vertices)};
  }
  probe_ = probe;
  return touch;
}

/// True if the proxy is free and nothing lies between it and the probe. move() would find the same, but slower.
bool MeshProxy::is_far(const Vec3& probe, const AabbTree& tree) const noexcept {
  return placed_ && held_ == 0 && anchor_.triangle == MeshTopology::kNone && is_finite(probe) && tree.is_far(towards(probe));
}

ProxyTouch MeshProxy::move(const Vec3& probe, std::span<const Vec3> vertices, const AabbTree& tree) noexcept {
  if (is_far(probe, tree)) {
    centre_ = probe_ = probe;
    return {.proxy = probe};
  }
  if (placed_) {
    carry(vertices, tree);
  } else if (is_finite(probe)) {
    centre_ = probe;
    placed_ = true;
    keep_distance(vertices, tree);
  }
  return settle(is_finite(probe) ? probe : probe_, vertices, tree);
}

ProxyTouch MeshProxy::move_to(const Vec3& probe, const InsideTest& inside, std::span<const Vec3> vertices,
                              const AabbTree& tree) noexcept {
  if (!is_finite(probe)) return move(probe_, vertices, tree);
  centre_ = probe;
  placed_ = true;
  if (const auto nearest = tree.closest(probe, vertices)) {
    const bool below = inside.contains(probe, *nearest, vertices);
    if (below) centre_ = nearest->point + (distance() + slack_) * inside.normal(*nearest, vertices);
    if (below || nearest->distance < distance()) keep_distance(vertices, tree);
  }
  return settle(probe, vertices, tree);
}

}  // namespace tactus::sim
