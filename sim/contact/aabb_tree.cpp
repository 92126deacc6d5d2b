// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/elementary.h>
#include <tactus/sim/contact/aabb_tree.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace tactus::sim {

// ==== aabb tree ====

namespace {

bool before(const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

double component(const Vec3& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// Whether a point is closer than the best so far. Ties are decided by position, then by number.
bool better(double distance2, const Vec3& point, std::uint32_t triangle, double best2, const SurfacePoint& best) {
  if (distance2 != best2 || best.triangle == MeshTopology::kNone) return distance2 <= best2;
  if (point != best.point) return before(point, best.point);
  return triangle < best.triangle;
}

}  // namespace

AabbTree::AabbTree(const TriMesh& mesh) {
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  build(mesh.triangles, all, mesh.vertices);
}

void AabbTree::reserve(std::size_t triangles, std::size_t numbers) {
  leaves_.reserve(triangles);
  nodes_.reserve(2 * triangles);
  leaf_of_.resize(numbers, kAbsent);
}

void AabbTree::build(std::span<const Triangle> triangles, std::span<const std::uint32_t> chosen, std::span<const Vec3> vertices) {
  for (const Leaf& leaf : leaves_) leaf_of_[leaf.triangle] = kAbsent;
  leaf_of_.resize(triangles.size(), kAbsent);
  leaves_.clear();
  nodes_.clear();
  for (const std::uint32_t number : chosen) {
    Leaf leaf{{}, number, {0, 1, 2}};
    const Triangle& corner = triangles[number];
    std::sort(leaf.order.begin(), leaf.order.end(),
              [&](std::uint8_t a, std::uint8_t b) { return before(vertices[corner[a]], vertices[corner[b]]); });
    for (std::size_t k = 0; k < 3; ++k) leaf.vertices[k] = corner[leaf.order[k]];
    leaves_.push_back(leaf);
  }
  if (!leaves_.empty()) split(0, static_cast<std::uint32_t>(leaves_.size()), vertices);
  for (std::uint32_t i = 0; i < leaves_.size(); ++i) leaf_of_[leaves_[i].triangle] = i;
  refit(vertices);
}

void AabbTree::split(std::uint32_t first, std::uint32_t last, std::span<const Vec3> vertices) {
  const std::size_t node = nodes_.size();
  nodes_.push_back({{}, first, last - first});
  if (last - first <= kLeafSize) return;
  const auto centre = [&](const Leaf& leaf, int axis) {  // three times the centre
    const Corners v = corners(leaf, vertices);
    return component(v[0], axis) + component(v[1], axis) + component(v[2], axis);
  };
  int longest = 0;
  double length = -1;
  for (int axis = 0; axis < 3; ++axis) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::uint32_t i = first; i < last; ++i) {
      const double x = centre(leaves_[i], axis);
      low = std::min(low, x);
      high = std::max(high, x);
    }
    if (high - low > length) {
      length = high - low;
      longest = axis;
    }
  }
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(leaves_.begin() + first, leaves_.begin() + middle, leaves_.begin() + last,
                   [&](const Leaf& a, const Leaf& b) { return centre(a, longest) < centre(b, longest); });
  split(first, middle, vertices);
  nodes_[node].next = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].count = 0;
  split(middle, last, vertices);
}

void AabbTree::refit(std::span<const Vec3> vertices) noexcept {
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    Node& node = nodes_[i];
    if (node.count == 0) {
      const Box &a = nodes_[i + 1].box, &b = nodes_[node.next].box;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        node.box.low[axis] = std::min(a.low[axis], b.low[axis]);
        node.box.high[axis] = std::max(a.high[axis], b.high[axis]);
      }
      continue;
    }
    Vec3 low = vertices[leaves_[node.next].vertices[0]], high = low;
    for (const Leaf& leaf : std::span(leaves_).subspan(node.next, node.count)) {
      for (const std::uint32_t vertex : leaf.vertices) {
        const Vec3& v = vertices[vertex];
        low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
        high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
      }
    }
    const auto fit = [&node](std::size_t axis, double least, double most) {
      const double margin = 0x1p-22 * std::max(std::abs(least), std::abs(most)) + std::numeric_limits<float>::min();
      node.box.low[axis] = static_cast<float>(least - margin);
      node.box.high[axis] = static_cast<float>(most + margin);
    };
    fit(0, low.x, high.x);
    fit(1, low.y, high.y);
    fit(2, low.z, high.z);
  }
}

Triangle AabbTree::triangle(std::uint32_t number) const noexcept {
  const Leaf& leaf = leaves_[leaf_of_[number]];
  Triangle out{};
  for (std::size_t k = 0; k < 3; ++k) out[leaf.order[k]] = leaf.vertices[k];
  return out;
}

SurfacePoint AabbTree::named(const Leaf& leaf, const std::array<double, 3>& weights, const Vec3& point,
                             double distance) noexcept {
  SurfacePoint out{leaf.triangle, {}, point, distance};
  for (std::size_t k = 0; k < 3; ++k) out.weights[leaf.order[k]] = weights[k];
  return out;
}

std::optional<SurfacePoint> AabbTree::closest(const Vec3& point, std::span<const Vec3> vertices, double within) const noexcept {
  if (nodes_.empty()) return std::nullopt;
  struct Entry {
    std::uint32_t node;
    double distance2;
  };
  std::array<Entry, kMaxDepth> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, distance2(nodes_[0].box, point)};
  SurfacePoint best;
  double best2 = within * within;
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.distance2 * (1 - 1e-14) > best2) continue;
    const Node& node = nodes_[entry.node];
    if (node.count == 0) {
      const Entry a{entry.node + 1, distance2(nodes_[entry.node + 1].box, point)};
      const Entry b{node.next, distance2(nodes_[node.next].box, point)};
      const bool a_first = a.distance2 <= b.distance2;
      stack[depth++] = a_first ? b : a;
      stack[depth++] = a_first ? a : b;
      continue;
    }
    for (const Leaf& leaf : std::span(leaves_).subspan(node.next, node.count)) {
      const TrianglePoint at = closest_on_triangle(point, corners(leaf, vertices));
      if (!better(at.distance2, at.point, leaf.triangle, best2, best)) continue;
      best = named(leaf, at.weights, at.point, 0);
      best2 = at.distance2;
    }
  }
  if (best.triangle == MeshTopology::kNone) return std::nullopt;
  best.distance = std::sqrt(best2);
  return best;
}

/// Test the separating axes of segment and box grown by the radius; in doubt they are near.
bool AabbTree::near_segment(const Box& box, const Vec3& from, const Vec3& displacement, double radius) noexcept {
  const auto half = [&](std::size_t axis) { return 0.5 * (double{box.high[axis]} - box.low[axis]) + radius; };
  const auto centre = [&](std::size_t axis) { return 0.5 * (double{box.high[axis]} + box.low[axis]); };
  const Vec3 h = 0.5 * displacement, m{from.x + h.x - centre(0), from.y + h.y - centre(1), from.z + h.z - centre(2)};
  const Vec3 a{std::abs(h.x), std::abs(h.y), std::abs(h.z)}, e{half(0), half(1), half(2)};
  const double rounding = 1e-15 * (std::abs(from.x) + std::abs(from.y) + std::abs(from.z) + a.x + a.y + a.z);
  if (std::abs(m.x) > e.x + a.x + rounding || std::abs(m.y) > e.y + a.y + rounding || std::abs(m.z) > e.z + a.z + rounding) {
    return false;
  }
  const auto apart = [rounding](double m1, double h2, double m2, double h1, double e1, double a2, double e2, double a1) {
    return std::abs(m1 * h2 - m2 * h1) >
           (e1 + rounding) * a2 + (e2 + rounding) * a1 + 1e-15 * (std::abs(m1) * a2 + std::abs(m2) * a1);
  };
  return !apart(m.y, h.z, m.z, h.y, e.y, a.z, e.z, a.y) && !apart(m.z, h.x, m.x, h.z, e.z, a.x, e.x, a.z) &&
         !apart(m.x, h.y, m.y, h.x, e.x, a.y, e.y, a.x);
}

/// Call test(leaf) for every triangle near the part of the path that still matters. It returns the fraction that matters from then on.
template <class Test>
void AabbTree::along(const Vec3& from, const Vec3& displacement, double radius, Test&& test) const noexcept {
  if (nodes_.empty()) return;
  std::array<std::uint32_t, kMaxDepth> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  Vec3 rest = displacement;
  while (depth > 0) {
    const std::uint32_t index = stack[--depth];
    const Node& node = nodes_[index];
    if (!near_segment(node.box, from, rest, radius)) continue;
    if (node.count != 0) {
      for (const Leaf& leaf : std::span(leaves_).subspan(node.next, node.count)) rest = test(leaf) * displacement;
      continue;
    }
    const Box &a = nodes_[index + 1].box, &b = nodes_[node.next].box;
    const auto lead = [&](std::size_t axis) { return double{b.low[axis]} + b.high[axis] - a.low[axis] - a.high[axis]; };
    const bool a_first = lead(0) * displacement.x + lead(1) * displacement.y + lead(2) * displacement.z >= 0;
    stack[depth++] = a_first ? node.next : index + 1;
    stack[depth++] = a_first ? index + 1 : node.next;
  }
}

std::optional<SurfaceHit> AabbTree::sweep(const Sweep& sphere, std::span<const Vec3> vertices,
                                          std::span<const std::uint32_t> left_out) const noexcept {
  std::optional<SurfaceHit> first;
  along(sphere.from, sphere.displacement, sphere.radius + sphere.slack, [&](const Leaf& leaf) {
    const double limit = first ? first->t : 1.0;
    if (std::find(left_out.begin(), left_out.end(), leaf.triangle) != left_out.end()) return limit;
    const auto hit = sphere_hits_triangle(sphere, corners(leaf, vertices), limit);
    if (!hit) return limit;
    const SurfaceHit found{hit->t, hit->rest, named(leaf, hit->at.weights, hit->at.point, std::sqrt(hit->at.distance2))};
    if (earlier(found, first)) first = found;
    return first->t;
  });
  return first;
}

std::optional<SurfaceHit> AabbTree::sweep(const Sweep& sphere, std::span<const Vec3> vertices,
                                          std::uint32_t triangle) const noexcept {
  const Leaf& leaf = leaves_[leaf_of_[triangle]];
  const auto hit = sphere_hits_triangle(sphere, corners(leaf, vertices), 1);
  if (!hit) return std::nullopt;
  return SurfaceHit{hit->t, hit->rest, named(leaf, hit->at.weights, hit->at.point, std::sqrt(hit->at.distance2))};
}

// ==== inside ====

namespace {

constexpr std::uint32_t kNone = MeshTopology::kNone;

Vec3 unit(const Vec3& v) {
  const double length = norm(v);
  return length > 0 ? (1 / length) * v : Vec3{};
}

double angle(const Vec3& a, const Vec3& b) { return angle_of(norm(cross(a, b)), dot(a, b)); }

}  // namespace

InsideTest::InsideTest(const TriMesh& mesh, const MeshTopology& topology)
    : mesh_(mesh), topology_(topology), closed_(mesh.triangles.size(), true) {
  std::vector<bool> seen(mesh.triangles.size(), false);
  std::vector<std::uint32_t> component;
  for (std::uint32_t start = 0; start < mesh.triangles.size(); ++start) {
    if (seen[start]) continue;
    component.assign(1, start);
    seen[start] = true;
    bool closed = true;
    for (std::size_t i = 0; i < component.size(); ++i) {
      for (unsigned k = 0; k < 3; ++k) {
        const std::uint32_t next = topology.across(component[i], k);
        closed = closed && next != kNone;
        if (next == kNone || seen[next]) continue;
        seen[next] = true;
        component.push_back(next);
      }
    }
    for (const std::uint32_t triangle : component) closed_[triangle] = closed;
  }
}

Vec3 InsideTest::normal(const SurfacePoint& at, std::span<const Vec3> vertices) const noexcept {
  const auto face = [&](std::uint32_t number) {
    const Triangle& t = mesh_.triangles[number];
    return unit(cross(vertices[t[1]] - vertices[t[0]], vertices[t[2]] - vertices[t[0]]));
  };
  if (at.feature() == Feature::face) return face(at.triangle);
  if (at.feature() == Feature::edge) {
    const unsigned opposite = at.weights[0] == 0 ? 0 : at.weights[1] == 0 ? 1 : 2;
    const std::uint32_t other = topology_.across(at.triangle, (opposite + 1) % 3);
    return other == kNone ? face(at.triangle) : unit(face(at.triangle) + face(other));
  }
  const std::size_t corner = at.weights[0] != 0 ? 0 : at.weights[1] != 0 ? 1 : 2;
  const std::uint32_t vertex = mesh_.triangles[at.triangle][corner];
  Vec3 sum;
  for (const std::uint32_t number : topology_.triangles_of(vertex)) {
    const Triangle& t = mesh_.triangles[number];
    const std::size_t k = t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
    const Vec3& here = vertices[vertex];
    sum = sum + angle(vertices[t[(k + 1) % 3]] - here, vertices[t[(k + 2) % 3]] - here) * face(number);
  }
  return unit(sum);
}

bool InsideTest::contains(const Vec3& point, const SurfacePoint& closest, std::span<const Vec3> vertices) const noexcept {
  return closed_[closest.triangle] && dot(point - closest.point, normal(closest, vertices)) < 0;
}

}  // namespace tactus::sim
