// SPDX-License-Identifier: Apache-2.0
/// Triangles of a polygon that is not convex: ears are clipped one by one [Meisters 1975], in the coordinate plane that the polygon faces
/// most. Triangles of a polygon that does not cross itself and whose triangles all face its way do not overlap. Internal to the library.
///
/// time O(n^2) for most, O(n^3) at worst; n corners
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <tactus/base/tri_mesh.h>

namespace tactus::sim {

class EarClipping {
 public:
  /// in  normal  of the polygon, not 0;  corner  positions in the order of the polygon
  EarClipping(const std::vector<Vec3>& corners, const Vec3& normal) {
    const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
    const bool along_x = x >= y && x >= z, along_y = !along_x && y >= z;
    const bool is_seen_from_behind = (along_x ? normal.x : along_y ? normal.y : normal.z) < 0;
    for (const Vec3& p : corners) {
      Point at = along_x ? Point{p.y, p.z} : along_y ? Point{p.z, p.x} : Point{p.x, p.y};
      if (is_seen_from_behind) std::swap(at.x, at.y);
      points_.push_back(at);
    }
  }

  /// Two edges that cross, by their first corners; none: the polygon does not cross itself.
  std::optional<std::pair<std::size_t, std::size_t>> crossing() const noexcept {
    const std::size_t n = points_.size();
    for (std::size_t i = 0; i + 2 < n; ++i)
      for (std::size_t k = i + 2; k < n; ++k) {
        const std::size_t j = i + 1, l = (k + 1) % n;
        if (side(i, j, k) * side(i, j, l) < 0 && side(k, l, i) * side(k, l, j) < 0) return std::pair(i, k);
      }
    return std::nullopt;
  }

  /// n - 2 triangles of corners, from 0.   out  none: corners are left between which there is no area
  std::optional<std::vector<std::array<std::size_t, 3>>> clip() const {
    std::vector<std::array<std::size_t, 3>> out;
    std::vector<std::size_t> left(points_.size());
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
    for (std::size_t at = 0; left.size() > 3;) {
      const auto ear = find_ear(left, at);
      if (!ear) return std::nullopt;
      const std::size_t n = left.size();
      out.push_back({left[(*ear + n - 1) % n], left[*ear], left[(*ear + 1) % n]});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(*ear));
      at = *ear % left.size();
    }
    if (side(left[0], left[1], left[2]) <= 0) return std::nullopt;
    out.push_back({left[0], left[1], left[2]});
    return out;
  }

 private:
  struct Point {
    double x, y;
  };

  /// 1: c is left of the line from a to b, -1: right of it, 0: on it
  int side(std::size_t a, std::size_t b, std::size_t c) const noexcept {
    const Point &p = points_[a], &q = points_[b], &r = points_[c];
    const long double left = (static_cast<long double>(q.x) - p.x) * (static_cast<long double>(r.y) - p.y);
    const long double right = (static_cast<long double>(q.y) - p.y) * (static_cast<long double>(r.x) - p.x);
    return left > right ? 1 : left < right ? -1 : 0;
  }
  bool are_same(std::size_t a, std::size_t b) const noexcept {
    return points_[a].x == points_[b].x && points_[a].y == points_[b].y;
  }

  bool is_ear(const std::vector<std::size_t>& left, std::size_t at) const noexcept {
    const std::size_t n = left.size(), a = left[(at + n - 1) % n], b = left[at], c = left[(at + 1) % n];
    if (side(a, b, c) <= 0) return false;
    for (const std::size_t p : left) {
      if (are_same(p, a) || are_same(p, b) || are_same(p, c)) continue;
      if (side(a, b, p) >= 0 && side(b, c, p) >= 0 && side(c, a, p) >= 0) return false;
    }
    return true;
  }

  /// The first from `at` on; one that leaves its neighbours corners, where there is one.
  std::optional<std::size_t> find_ear(const std::vector<std::size_t>& left, std::size_t at) const noexcept {
    const std::size_t n = left.size();
    std::optional<std::size_t> any;
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t i = (at + k) % n;
      if (!is_ear(left, i)) continue;
      const std::size_t a = left[(i + n - 1) % n], c = left[(i + 1) % n];
      if (side(left[(i + n - 2) % n], a, c) != 0 && side(a, c, left[(i + 2) % n]) != 0) return i;
      if (!any) any = i;
    }
    return any;
  }

  std::vector<Point> points_;
};

}  // namespace tactus::sim
