// SPDX-License-Identifier: Apache-2.0
#include <tactus/metrics/deformable_errors.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <tactus/deformable/displacement.h>
#include <tactus/mesh/graph.h>

namespace tactus {

struct DeformableErrors::Area {
  explicit Area(const TriMesh& rest) : mesh(of(rest)), rings(mesh), bound(rest.vertices.size()), inside(rest.vertices.size()) {}

  static DeformableObject of(const TriMesh& rest) {
    DeformableObject out;
    out.rest.resize(rest.vertices.size());  // rings follow from the triangles alone
    out.triangles = rest.triangles;
    return out;
  }

  DeformableObject mesh;
  Rings rings;
  std::vector<double> bound;         // [m] by vertex
  std::vector<std::uint8_t> inside;  // by vertex
};

DeformableErrors::DeformableErrors(const TriMesh& rest, const DeformableThresholds& bounds, std::uint8_t rings,
                                   unsigned position_exp)
    : bounds_(bounds),
      rings_(rings),
      position_exp_(position_exp),
      rounding_(std::ldexp(std::sqrt(3.0) / 2 * (1 + 1e-12), -static_cast<int>(position_exp))),
      finder_(std::make_unique<Area>(rest)) {}
DeformableErrors::DeformableErrors(DeformableErrors&&) noexcept = default;
DeformableErrors& DeformableErrors::operator=(DeformableErrors&&) noexcept = default;
DeformableErrors::~DeformableErrors() = default;

void DeformableErrors::begin(const std::optional<SurfaceTouch>& touch) noexcept {
  Area& area = *finder_;
  const double visual = std::max(bounds_.visual, rounding_);
  std::ranges::fill(area.bound, visual);
  std::ranges::fill(area.inside, std::uint8_t{0});
  ++frames_;
  if (!touch) return;
  double haptic = std::numeric_limits<double>::infinity();
  if (bounds_.weber_fraction) haptic = haptic_threshold(bounds_, *touch);
  ++touched_;
  haptic_sum_ += bounds_.weber_fraction ? haptic : 0;
  area.rings.triangles_around(touch->triangle, rings_);
  for (const std::uint32_t v : area.rings.vertices()) {
    area.inside[v] = 1;
    area.bound[v] = std::max(std::min(visual, haptic), rounding_);
  }
}

void DeformableErrors::add(std::size_t vertex, const Vec3& error) noexcept {
  const double size = norm(error), bound = finder_->bound[vertex];
  const bool violates = size > bound;
  const auto count = [size, violates](VertexErrors& errors) {
    ++errors.vertices;
    errors.violations += violates ? 1 : 0;
    errors.square_sum += size * size;
    errors.max = std::max(errors.max, size);
  };
  count(all_);
  if (finder_->inside[vertex] != 0) count(area_);
  worst_ratio_ = std::max(worst_ratio_, size / bound);
}

void DeformableErrors::add(std::span<const float> truth, std::span<const std::array<std::int32_t, 3>> shown,
                           const std::optional<SurfaceTouch>& touch) noexcept {
  begin(touch);
  for (std::size_t v = 0; v < shown.size(); ++v)
    add(v, Vec3{truth[3 * v], truth[3 * v + 1], truth[3 * v + 2]} - to_metres(shown[v], position_exp_));
}

void DeformableErrors::add(std::span<const float> truth, std::span<const float> shown,
                           const std::optional<SurfaceTouch>& touch) noexcept {
  begin(touch);
  for (std::size_t v = 0; 3 * v < shown.size(); ++v)
    add(v, Vec3{truth[3 * v], truth[3 * v + 1], truth[3 * v + 2]} - Vec3{shown[3 * v], shown[3 * v + 1], shown[3 * v + 2]});
}

double DeformableErrors::mean_haptic() const noexcept { return touched_ == 0 ? 0 : haptic_sum_ / static_cast<double>(touched_); }

}  // namespace tactus
