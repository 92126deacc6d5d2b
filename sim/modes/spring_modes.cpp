// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/modes/spring_modes.h>

#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <tactus/base/rule.h>
#include <tactus/sim/modes/slowest_modes.h>

namespace tactus::sim {
namespace {

using Matrix = SymmetricMatrix;

constexpr double kReach = 2.3;  // mean edges

double mean_edge(const TriMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) sum += norm(mesh.vertices[t[k]] - mesh.vertices[t[(k + 1) % 3]]);
  return mesh.triangles.empty() ? 0 : sum / static_cast<double>(3 * mesh.triangles.size());
}

/// Vertices sorted into boxes as wide as the longest spring.
class Boxes {
 public:
  Boxes(const TriMesh& mesh, double width) : width_(width) {
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) boxes_[cell_of(mesh.vertices[v])].push_back(v);
  }
  template <class Visit>
  void near(const Vec3& at, Visit visit) const {
    const Cell middle = cell_of(at);
    for (std::int64_t x = -1; x <= 1; ++x)
      for (std::int64_t y = -1; y <= 1; ++y)
        for (std::int64_t z = -1; z <= 1; ++z) {
          const auto found = boxes_.find({middle[0] + x, middle[1] + y, middle[2] + z});
          if (found != boxes_.end()) std::ranges::for_each(found->second, visit);
        }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cell_of(const Vec3& v) const {
    const auto box = [this](double x) { return static_cast<std::int64_t>(std::floor(x / width_)); };
    return {box(v.x), box(v.y), box(v.z)};
  }
  double width_;
  std::map<Cell, std::vector<std::uint32_t>> boxes_;
};

constexpr std::int32_t kFixed = -1;

/// First of a vertex's three rows, or kFixed.
std::vector<std::int32_t> rows_of(std::size_t vertices, std::span<const std::uint32_t> fixed) {
  std::vector<std::int32_t> rows(vertices, 0);
  for (const std::uint32_t v : fixed) rows[v] = kFixed;
  std::int32_t next = 0;
  for (std::int32_t& row : rows)
    if (row != kFixed) row = std::exchange(next, next + 3);
  return rows;
}

Matrix stiffness(const TriMesh& mesh, std::span<const std::int32_t> rows, std::int32_t size) {
  const double reach = kReach * mean_edge(mesh);
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](std::int32_t row, std::int32_t column, const std::array<double, 3>& n, double sign) {
    for (std::int32_t i = 0; i < 3; ++i)
      for (std::int32_t k = 0; k < 3; ++k)
        entries.emplace_back(row + i, column + k, sign * n[static_cast<std::size_t>(i)] * n[static_cast<std::size_t>(k)]);
  };
  const Boxes boxes(mesh, reach > 0 ? reach : 1);
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    if (rows[v] == kFixed) continue;
    boxes.near(mesh.vertices[v], [&](std::uint32_t other) {
      const Vec3 along = mesh.vertices[other] - mesh.vertices[v];
      const double length = norm(along);
      if (!(length > 0 && length < reach)) return;
      const std::array<double, 3> n{along.x / length, along.y / length, along.z / length};
      add(rows[v], rows[v], n, 1);
      if (rows[other] != kFixed) add(rows[v], rows[other], n, -1);
    });
  }
  Matrix out(size, size);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

}  // namespace

Result<std::vector<double>> spring_modes(const TriMesh& rest, std::span<const std::uint32_t> fixed, std::size_t modes) {
  const auto rows = rows_of(rest.vertices.size(), fixed);
  const auto free = static_cast<std::int32_t>(3 * (rest.vertices.size() - fixed.size()));
  const auto count = static_cast<std::int32_t>(modes);
  if (count < 1 || count >= free) return fail(Errc::invalid_argument, "R-API-9");

  Matrix masses(free, free);
  masses.setIdentity();
  const auto found = slowest_modes(stiffness(rest, rows, free), masses, count);
  if (!found) return fail(Errc::internal, "R-SIM-5");

  std::vector<double> out;
  out.reserve(modes * 3 * rest.vertices.size());
  for (std::int32_t k = 0; k < count; ++k)
    for (const std::int32_t row : rows)
      for (std::int32_t i = 0; i < 3; ++i) out.push_back(row == kFixed ? 0.0 : found->shapes(row + i, k));
  return out;
}

}  // namespace tactus::sim
