// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/motion_clusters.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <tactus/base/rule.h>
#include <tactus/mesh/graph.h>

namespace tactus {
namespace {

constexpr int kWideRounds = 5, kRounds = 20;   // the first among all clusters
constexpr std::size_t kLeast = 8;              // vertices of a cluster that stays
constexpr double kDamping = 1e-9;              // of the normal equations, relative to their trace
constexpr std::size_t kVerticesPerRound = 16;  // of a cluster, for each round of blending
constexpr double kFar = std::numeric_limits<double>::infinity();

using Row = std::array<double, 4>;  // 1, x, y, z

/// Affine maps of one cluster: 4 rows of numbers, one for each coordinate of each shape.
struct Map {
  std::vector<double> rows;
};

class Clusters {
 public:
  Clusters(const TriMesh& rest, std::span<const std::vector<float>> shapes, std::size_t most)
      : width_(3 * shapes.size()), most_(most) {
    DeformableObject mesh;  // for its neighbours, which are the same on any grid
    mesh.triangles = rest.triangles;
    mesh.rest.resize(rest.vertices.size());
    for (std::uint32_t v = 0; v < mesh.rest.size(); ++v) mesh.rest[v] = {static_cast<std::int32_t>(v), 0, 0};
    near_ = neighbours(mesh);
    read(rest, shapes);
  }

  std::vector<std::uint8_t> find() {
    cluster_.assign(rows_.size(), 0);
    maps_.push_back(fit(all()));
    errors_.resize(rows_.size());
    for (std::uint32_t v = 0; v < rows_.size(); ++v) errors_[v] = error(v, maps_[0]);
    while (maps_.size() < std::min(most_, std::max<std::size_t>(1, rows_.size() / kLeast))) seed();
    for (int round = 0; round < kRounds && improve(round < kWideRounds); ++round) {
    }
    return numbered();
  }

 private:
  void read(const TriMesh& rest, std::span<const std::vector<float>> shapes) {
    Vec3 low = rest.vertices[0], high = low;
    for (const Vec3& p : rest.vertices) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const Vec3 middle = 0.5 * (low + high);
    const double size = std::max(norm(high - low), std::numeric_limits<double>::min());
    for (const Vec3& p : rest.vertices)
      rows_.push_back({1, (p.x - middle.x) / size, (p.y - middle.y) / size, (p.z - middle.z) / size});
    paths_.reserve(width_ * rows_.size());
    for (std::size_t v = 0; v < rows_.size(); ++v)
      for (const std::vector<float>& shape : shapes)
        for (std::size_t axis = 0; axis < 3; ++axis) paths_.push_back(shape[3 * v + axis]);
  }
  std::span<const double> path(std::uint32_t v) const noexcept { return std::span(paths_).subspan(v * width_, width_); }
  std::vector<std::uint32_t> all() const {
    std::vector<std::uint32_t> out(rows_.size());
    for (std::uint32_t v = 0; v < out.size(); ++v) out[v] = v;
    return out;
  }

  /// Least squares over the vertices: normal equations of four unknowns for each coordinate of each shape.
  Map fit(std::span<const std::uint32_t> vertices) const {
    std::array<Row, 4> gram{};
    Map map{std::vector<double>(4 * width_)};
    for (const std::uint32_t v : vertices) {
      const Row& row = rows_[v];
      const auto p = path(v);
      for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) gram[i][j] += row[i] * row[j];
        for (std::size_t k = 0; k < width_; ++k) map.rows[i * width_ + k] += row[i] * p[k];
      }
    }
    const double damping = kDamping * (gram[0][0] + gram[1][1] + gram[2][2] + gram[3][3]);
    for (std::size_t i = 0; i < 4; ++i) gram[i][i] += damping;
    for (std::size_t j = 0; j < 4; ++j) {  // Gauss and Jordan; the matrix is positive definite
      for (std::size_t i = 0; i < 4; ++i) {
        if (i == j) continue;
        const double f = gram[i][j] / gram[j][j];
        for (std::size_t k = j; k < 4; ++k) gram[i][k] -= f * gram[j][k];
        for (std::size_t k = 0; k < width_; ++k) map.rows[i * width_ + k] -= f * map.rows[j * width_ + k];
      }
    }
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k < width_; ++k) map.rows[i * width_ + k] /= gram[i][i];
    return map;
  }
  double error(std::uint32_t v, const Map& map) const noexcept {
    const Row& row = rows_[v];
    const auto p = path(v);
    const double* m = map.rows.data();
    double sum = 0;
    for (std::size_t k = 0; k < width_; ++k) {
      const double e = m[k] + row[1] * m[width_ + k] + row[2] * m[2 * width_ + k] + row[3] * m[3 * width_ + k] - p[k];
      sum += e * e;
    }
    return sum;
  }

  /// A new cluster around the vertex that the others fit worst.
  void seed() {
    const auto worst = static_cast<std::uint32_t>(std::ranges::max_element(errors_) - errors_.begin());
    std::vector<std::uint32_t> around{worst};
    std::vector<char> taken(rows_.size(), 0);
    taken[worst] = 1;
    const std::size_t size = std::max(std::size_t{12}, rows_.size() / (3 * most_));
    for (std::size_t i = 0; i < around.size() && around.size() < size; ++i) {
      for (const std::uint32_t w : near_[around[i]]) {
        if (taken[w] || around.size() == size) continue;
        taken[w] = 1;
        around.push_back(w);
      }
    }
    const auto c = static_cast<std::uint8_t>(maps_.size());
    maps_.push_back(fit(around));
    for (std::uint32_t v = 0; v < rows_.size(); ++v) {
      const double e = error(v, maps_.back());
      if (e >= errors_[v] && v != worst) continue;
      cluster_[v] = c;
      errors_[v] = v == worst ? 0 : e;  // where a part of the mesh is a single vertex, it is not chosen again
    }
  }

  /// One round: each vertex goes to the cluster that fits it best, of all or of its neighbours'. False when none moved.
  bool improve(bool wide) {
    std::vector<std::vector<std::uint32_t>> members(maps_.size());
    for (std::uint32_t v = 0; v < rows_.size(); ++v) members[cluster_[v]].push_back(v);
    for (std::size_t c = 0; c < maps_.size(); ++c) maps_[c] = members[c].size() < kLeast ? Map{} : fit(members[c]);
    bool moved = false;
    for (std::uint32_t v = 0; v < rows_.size(); ++v) {
      std::uint8_t best = cluster_[v];
      double least = error_in(v, best);
      const auto consider = [&](std::uint8_t c) {
        if (c == best) return;
        if (const double e = error_in(v, c); e < least) {
          least = e;
          best = c;
        }
      };
      for (std::uint8_t c = 0; wide && c < maps_.size(); ++c) consider(c);
      for (const std::uint32_t w : near_[v]) consider(cluster_[w]);
      moved = moved || best != cluster_[v];
      cluster_[v] = best;
    }
    return moved;
  }
  double error_in(std::uint32_t v, std::uint8_t c) const noexcept { return maps_[c].rows.empty() ? kFar : error(v, maps_[c]); }

  /// Without the clusters that nothing is left of.
  std::vector<std::uint8_t> numbered() const {
    std::vector<int> number(maps_.size(), -1);
    std::vector<std::uint8_t> out;
    int next = 0;
    for (const std::uint8_t c : cluster_) {
      if (number[c] < 0) number[c] = next++;
      out.push_back(static_cast<std::uint8_t>(number[c]));
    }
    return out;
  }

  std::size_t width_, most_;
  Neighbours near_;
  std::vector<Row> rows_;      // by vertex
  std::vector<double> paths_;  // by vertex, shape and axis
  std::vector<std::uint8_t> cluster_;
  std::vector<Map> maps_;
  std::vector<double> errors_;
};

}  // namespace

Result<ClusterBasis> motion_clusters(const TriMesh& rest, std::span<const std::vector<float>> shapes, std::size_t count) try {
  if (count < 1 || count > ClusterBasis::kMaxClusters) return fail(Errc::invalid_argument, "R-API-4");
  if (shapes.empty() || rest.vertices.empty()) return fail(Errc::invalid_argument, "R-API-5");
  for (const std::vector<float>& shape : shapes) {
    if (shape.size() != 3 * rest.vertices.size()) return fail(Errc::invalid_argument, "R-API-5");
    if (!std::ranges::all_of(shape, [](float x) { return std::isfinite(x); })) return fail(Errc::invalid_argument, "R-API-1");
  }
  if (!std::ranges::all_of(rest.vertices, [](const Vec3& p) { return is_finite(p); }))
    return fail(Errc::invalid_argument, "R-API-1");
  ClusterBasis out{.clusters = Clusters(rest, shapes, count).find()};
  out.count = static_cast<std::uint8_t>(*std::ranges::max_element(out.clusters) + 1);
  const std::size_t vertices = rest.vertices.size();
  const std::size_t affordable = std::max<std::size_t>(4, (std::size_t{1} << 24) / vertices) - 4;  // R-STR-21
  out.blend = static_cast<std::uint8_t>(
      std::min({vertices / (kVerticesPerRound * out.count), affordable, std::size_t{ClusterBasis::kMaxBlend}}));
  return out;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

}  // namespace tactus
