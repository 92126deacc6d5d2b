// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/contact/intermediate_model.h>

#include <algorithm>
#include <cmath>

namespace tactus::sim {
namespace {

constexpr int kMaxHalvings = 3;  // of a path that leaves the cut-out

double extent_of(std::span<const Vec3> vertices) {
  double extent = 0;
  for (const Vec3& v : vertices) extent = std::max({extent, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return extent;
}

}  // namespace

IntermediateModel::IntermediateModel(const TriMesh& mesh, const MeshTopology& topology, const IntermediateModelOptions& options)
    : mesh_(mesh),
      topology_(topology),
      options_(options),
      inside_(mesh, topology),
      proxy_(options.proxy, extent_of(mesh.vertices)),
      is_moving_(mesh.vertices.size(), 0),
      is_rim_(mesh.triangles.size(), 0),
      from_(mesh.vertices),
      to_(mesh.vertices),
      shown_(mesh.vertices),
      next_(mesh.vertices) {
  std::size_t largest = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    topology.rings_around(t, options.rings, cut_);
    largest = std::max(largest, cut_.size());
  }
  cut_.clear();
  moving_.reserve(3 * largest);
  tree_.reserve(largest, mesh.triangles.size());
}

void IntermediateModel::cut_around(std::uint32_t triangle) noexcept {
  if (still_ > 1 && triangle == cut_around_triangle_) return;  // the cut-out would be the same
  cut_around_triangle_ = triangle;
  for (const std::uint32_t t : cut_) is_rim_[t] = 0;
  for (const std::uint32_t v : moving_) is_moving_[v] = 0;
  topology_.rings_around(triangle, options_.rings, cut_);
  moving_.clear();
  for (const std::uint32_t t : cut_) {
    for (const std::uint32_t v : mesh_.triangles[t]) {
      if (is_moving_[v] != 0) continue;
      is_moving_[v] = 1;
      moving_.push_back(v);
    }
  }
  tree_.build(mesh_.triangles, cut_, shown_);
  const auto is_outside = [this](std::uint32_t t) { return !tree_.contains(t); };
  for (const std::uint32_t v : moving_) {
    const auto around = topology_.triangles_of(v);
    if (std::none_of(around.begin(), around.end(), is_outside)) continue;
    for (const std::uint32_t t : around)
      if (tree_.contains(t)) is_rim_[t] = 1;
  }
}

ProxyTouch IntermediateModel::move_to(const Vec3& probe, std::span<const Vec3> vertices, const AabbTree& tree) noexcept {
  std::copy(vertices.begin(), vertices.end(), shown_.begin());
  from_ = to_ = shown_;
  reach_ = 0;
  still_ = 0;
  touch_ = proxy_.move_to(probe, inside_, vertices, tree);
  if (const auto nearest = tree.closest(proxy_.position(), vertices)) cut_around(nearest->triangle);
  tick_ = 0;
  return touch_;
}

void IntermediateModel::update(std::span<const Vec3> vertices, const AabbTree& tree) noexcept {
  bool moves = false;
  for (std::size_t v = 0; v < shown_.size(); ++v) {
    if (is_moving_[v] == 0) shown_[v] = to_[v];
    moves = moves || shown_[v] != vertices[v];
    from_[v] = shown_[v];
    to_[v] = vertices[v];
  }
  still_ = moves ? 0 : still_ + 1;
  recut(vertices, tree);
}

void IntermediateModel::update_at_rest(std::span<const Vec3> vertices, const AabbTree& tree) noexcept {
  if (still_ == 0) return update(vertices, tree);
  ++still_;
  recut(vertices, tree);
}

void IntermediateModel::recut(std::span<const Vec3> vertices, const AabbTree& tree) noexcept {
  tick_ = 0;
  if (touch_.touched) {
    cut_around(touch_.triangle);
  } else if (const auto nearest = tree.closest(proxy_.position(), vertices)) {
    cut_around(nearest->triangle);
    touch_ = proxy_.move_to(proxy_.position(), inside_, shown_, tree_);
  }
  double farthest2 = 0;
  for (const std::uint32_t v : moving_) farthest2 = std::max(farthest2, dot(to_[v] - from_[v], to_[v] - from_[v]));
  reach_ = std::sqrt(farthest2) / options_.ticks;
}

/// Move the vertices one tick closer to the result of the deformation step.
void IntermediateModel::approach() noexcept {
  tick_ = std::min(tick_ + 1, options_.ticks);
  if (reach_ == 0) return;
  const double fraction = static_cast<double>(tick_) / options_.ticks;
  for (const std::uint32_t v : moving_) next_[v] = fraction < 1 ? from_[v] + fraction * (to_[v] - from_[v]) : to_[v];
  proxy_.expect(reach_, shown_, next_, tree_);
  for (const std::uint32_t v : moving_) shown_[v] = next_[v];
  tree_.refit(shown_);
}

/// Did the proxy lose the surface only because the cut-out ends there?
bool IntermediateModel::falls_off(const ProxyTouch& touch, const Vec3& probe) const noexcept {
  if (!touch_.touched || dot(probe - touch_.proxy, touch_.normal) >= 0) return false;
  if (touch.touched && dot(touch.normal, touch_.normal) >= 0) return false;
  const auto nearest = tree_.closest(touch.proxy, shown_);
  return nearest && is_rim_[nearest->triangle] != 0;
}

ProxyTouch IntermediateModel::move(const Vec3& probe) noexcept {
  approach();
  const MeshProxy before = proxy_;
  const Vec3 below = touch_.proxy + dot(probe - touch_.proxy, touch_.normal) * touch_.normal;
  Vec3 goal = probe;
  ProxyTouch touch = proxy_.move(goal, shown_, tree_);
  for (int halvings = 0; falls_off(touch, goal); ++halvings) {
    proxy_ = before;
    if (halvings == kMaxHalvings) {
      proxy_.carry(shown_, tree_);
      touch = touch_;
      touch.proxy = proxy_.position();
      break;
    }
    goal = below + 0.5 * (goal - below);
    touch = proxy_.move(goal, shown_, tree_);
  }
  touch_ = touch;
  return touch;
}

}  // namespace tactus::sim
