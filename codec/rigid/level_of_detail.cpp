// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/level_of_detail.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tactus {
namespace {

constexpr double kHysteresis = 1.15;  // a level rises only where a distance so many times smaller would ask for it, too
constexpr double kScan = 0.2;         // [s] for all objects
constexpr double kStep = 1.0 / 16;    // of the distance within which objects are sent in full

double square(double v) noexcept { return v * v; }

double distance_squared(const std::array<double, 3>& a, const std::array<double, 3>& b) noexcept {
  return square(a[0] - b[0]) + square(a[1] - b[1]) + square(a[2] - b[2]);
}

}  // namespace

LevelsOfDetail::LevelsOfDetail(const Scene& scene)
    : scene_(scene),
      step_(square(kStep * scene.interest->full)),
      slice_(
          static_cast<std::size_t>(std::ceil(static_cast<double>(scene.moving().size()) / std::ceil(kScan * scene.tick_rate)))),
      levels_(scene.objects.size(), kLeftOut) {
  const double reach = scene.interest->reach;
  for (std::size_t i = 0; i < limits_.size(); ++i)
    limits_[i] = square(std::min(std::ldexp(scene.interest->full, static_cast<int>(i)), reach));
  limits_.back() = square(reach);
}

void LevelsOfDetail::set_viewpoints(std::span<const Vec3> viewpoints) noexcept {
  const std::size_t before = std::exchange(count_, 0);
  const double unit = std::ldexp(1.0, -scene_.grid.position);
  for (const Vec3& p : viewpoints)
    if (is_finite(p) && count_ < kMostViewpoints) viewpoints_[count_++] = {p.x / unit, p.y / unit, p.z / unit};
  bool moved = !std::exchange(looks_, true) || count_ != before;
  for (std::size_t i = 0; i < count_; ++i) moved = moved || distance_squared(viewpoints_[i], scanned_[i]) > step_;
  if (!moved) return;
  scanned_ = viewpoints_;
  left_ = scene_.moving().size();
}

std::uint8_t LevelsOfDetail::level_at(double square) const noexcept {
  std::uint8_t level = 0;
  while (level < kOutOfInterest && square > limits_[level]) ++level;
  return level;
}

void LevelsOfDetail::look(std::uint32_t object, const RigidTruth& truth) noexcept {
  if (!looks_) {
    levels_[object] = 0;
    return;
  }
  const std::uint8_t before = of(object);
  const auto& p = truth.state(object).position;
  const Position at{double(p[0]), double(p[1]), double(p[2])};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count_; ++i) least = std::min(least, distance_squared(at, viewpoints_[i]));
  const std::uint8_t wanted = level_at(least);
  std::uint8_t level = wanted;
  if (wanted > before) level = std::max(before, level_at(least / square(kHysteresis)));
  if (wanted != kOutOfInterest && truth.is_touched(object)) level = 0;
  if (level != before) levels_[object] = level;
}

}  // namespace tactus
