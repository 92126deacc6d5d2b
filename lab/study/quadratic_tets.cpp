// SPDX-License-Identifier: Apache-2.0
#include "lab/study/quadratic_tets.h"

#include <Eigen/Dense>
#include <Eigen/IterativeLinearSolvers>
#include <algorithm>
#include <array>
#include <utility>

#include <tactus/base/rule.h>

namespace tactus::sim::study {
namespace {

constexpr int kNodes = 10;
constexpr double kResidual = 1e-5;  // of the load; 12 digits of the deflection are then as with 1e-11, on two meshes
constexpr std::array<std::pair<int, int>, 6> kEdges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

using Element = std::array<std::uint32_t, kNodes>;  // corners, then the middles of kEdges
using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge edge_between(std::uint32_t a, std::uint32_t b) { return std::minmax(a, b); }

/// Every edge once; the node in its middle is number (vertices + its index here).
std::vector<Edge> edges_of(const TetMesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(6 * mesh.tets.size());
  for (const Tet& tet : mesh.tets)
    for (const auto& [a, b] : kEdges)
      edges.push_back(edge_between(tet[static_cast<std::size_t>(a)], tet[static_cast<std::size_t>(b)]));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

class Mesh {
 public:
  explicit Mesh(const PrecisionScene& scene) : scene_(scene), edges_(edges_of(scene.mesh)) {
    std::vector<bool> is_fixed(vertices(), false);
    for (const std::uint32_t v : scene.fixed) is_fixed[v] = true;
    number_.assign(vertices() + edges_.size(), -1);
    for (std::size_t node = 0; node < number_.size(); ++node) {
      const bool fixed = node < vertices() ? is_fixed[node] : is_fixed[edge(node).first] && is_fixed[edge(node).second];
      if (!fixed) number_[node] = free_++;
    }
  }

  std::size_t vertices() const { return scene_.mesh.vertices.size(); }
  const Edge& edge(std::size_t node) const { return edges_[node - vertices()]; }
  int free_nodes() const { return free_; }
  int number(std::uint32_t node) const { return number_[node]; }  ///< among the free ones, -1: fixed
  std::uint32_t middle(std::uint32_t a, std::uint32_t b) const {
    const auto found = std::lower_bound(edges_.begin(), edges_.end(), edge_between(a, b));
    return static_cast<std::uint32_t>(vertices() + static_cast<std::size_t>(found - edges_.begin()));
  }
  Element element(const Tet& tet) const {
    Element out{tet[0], tet[1], tet[2], tet[3]};
    for (std::size_t i = 0; i < kEdges.size(); ++i)
      out[4 + i] = middle(tet[static_cast<std::size_t>(kEdges[i].first)], tet[static_cast<std::size_t>(kEdges[i].second)]);
    return out;
  }

 private:
  const PrecisionScene& scene_;
  std::vector<Edge> edges_;
  std::vector<int> number_;
  int free_ = 0;
};

using Gradients = Eigen::Matrix<double, kNodes, 3>;
using Stiffness = Eigen::Matrix<double, 3 * kNodes, 3 * kNodes>;

/// N = s (2 s - 1) at corners, 4 s_a s_b in middles, with the barycentric coordinates s.
Gradients shape_gradients(const Eigen::Matrix<double, 4, 3>& of_barycentric, const Eigen::Vector4d& barycentric) {
  Gradients out;
  for (int i = 0; i < 4; ++i) out.row(i) = (4 * barycentric[i] - 1) * of_barycentric.row(i);
  for (int i = 0; i < 6; ++i) {
    const auto [a, b] = kEdges[static_cast<std::size_t>(i)];
    out.row(4 + i) = 4 * (barycentric[a] * of_barycentric.row(b) + barycentric[b] * of_barycentric.row(a));
  }
  return out;
}

/// Integral of lambda div u div v + 2 mu e(u) : e(v); the four points are exact for the quadratic integrand.
Stiffness element_stiffness(const TetMesh& mesh, std::size_t tet, const Material& material) {
  const double mu = material.young / (2 * (1 + material.poisson));
  const double lambda = 2 * mu * material.poisson / (1 - 2 * material.poisson);
  Eigen::Matrix4d corners;
  for (int i = 0; i < 4; ++i) {
    const Vec3& p = mesh.vertices[mesh.tets[tet][static_cast<std::size_t>(i)]];
    corners.col(i) << 1, p.x, p.y, p.z;
  }
  const Eigen::Matrix<double, 4, 3> of_barycentric = corners.inverse().rightCols<3>();
  Stiffness out = Stiffness::Zero();
  for (int point = 0; point < 4; ++point) {
    Eigen::Vector4d barycentric = Eigen::Vector4d::Constant(0.1381966011250105);  // (5 - sqrt 5) / 20
    barycentric[point] = 0.5854101966249685;
    const Gradients g = shape_gradients(of_barycentric, barycentric);
    const double weight = volume(mesh, tet) / 4;
    for (Eigen::Index a = 0; a < kNodes; ++a) {
      for (Eigen::Index b = 0; b < kNodes; ++b) {
        Eigen::Matrix3d block = lambda * g.row(a).transpose() * g.row(b) + mu * g.row(b).transpose() * g.row(a);
        block.diagonal().array() += mu * g.row(a).dot(g.row(b));
        out.block<3, 3>(3 * a, 3 * b) += weight * block;
      }
    }
  }
  return out;
}

/// Zeros where free nodes share an element. Made node by node, since triplets of all elements would fill the memory.
SparseMatrix pattern(const Mesh& mesh, const TetMesh& tets) {
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(mesh.free_nodes()));
  for (const Tet& tet : tets.tets) {
    const Element element = mesh.element(tet);
    for (const std::uint32_t a : element)
      for (const std::uint32_t b : element)
        if (mesh.number(a) >= 0 && mesh.number(b) >= 0)
          neighbours[static_cast<std::size_t>(mesh.number(a))].push_back(mesh.number(b));
  }
  std::vector<int> sizes;
  for (std::vector<int>& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    sizes.insert(sizes.end(), 3, 3 * static_cast<int>(list.size()));
  }
  const Eigen::Index size = 3 * Eigen::Index{mesh.free_nodes()};
  SparseMatrix out(size, size);
  out.reserve(sizes);
  for (int row = 0; row < out.rows(); ++row)
    for (const int node : neighbours[static_cast<std::size_t>(row / 3)])
      for (int axis = 0; axis < 3; ++axis) out.insert(row, 3 * node + axis) = 0;
  out.makeCompressed();
  return out;
}

SparseMatrix assemble(const Mesh& mesh, const PrecisionScene& scene) {
  SparseMatrix out = pattern(mesh, scene.mesh);
  for (std::size_t e = 0; e < scene.mesh.tets.size(); ++e) {
    const Element element = mesh.element(scene.mesh.tets[e]);
    const Stiffness local = element_stiffness(scene.mesh, e, scene.material);
    for (int a = 0; a < 3 * kNodes; ++a) {
      const int row = mesh.number(element[static_cast<std::size_t>(a / 3)]);
      if (row < 0) continue;
      for (int b = 0; b < 3 * kNodes; ++b) {
        const int column = mesh.number(element[static_cast<std::size_t>(b / 3)]);
        if (column >= 0) out.coeffRef(3 * Eigen::Index{row} + a % 3, 3 * Eigen::Index{column} + b % 3) += local(a, b);
      }
    }
  }
  return out;
}

/// Integrals of the shape functions over the pressed triangles, over their area: a third in each middle, none at the corners.
Eigen::VectorXd pressure(const Mesh& mesh, const PrecisionScene& scene) {
  const TetSurface skin = surface(scene.mesh);
  const std::vector<std::uint32_t>& patch = scene.patch.vertices;
  Eigen::VectorXd out = Eigen::VectorXd::Zero(3 * Eigen::Index{mesh.free_nodes()});
  double total = 0;
  for (const Triangle& t : skin.mesh.triangles) {
    const Triangle corners{skin.vertex[t[0]], skin.vertex[t[1]], skin.vertex[t[2]]};
    const auto is_pressed = [&](std::uint32_t v) { return std::binary_search(patch.begin(), patch.end(), v); };
    if (!std::all_of(corners.begin(), corners.end(), is_pressed)) continue;
    const auto& points = skin.mesh.vertices;
    const double area = norm(cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]])) / 2;
    for (std::size_t i = 0; i < 3; ++i) {
      const int node = mesh.number(mesh.middle(corners[i], corners[(i + 1) % 3]));
      if (node >= 0) out[3 * Eigen::Index{node} + 2] += area / 3;
    }
    total += area;
  }
  return out / total;
}

}  // namespace

tl::expected<double, Diagnostic> quadratic_static_deflection(const PrecisionScene& scene) {
  const Mesh mesh(scene);
  const SparseMatrix stiffness = assemble(mesh, scene);
  const Eigen::VectorXd load = pressure(mesh, scene);
  // A factor of the finest mesh would hold a thousand million numbers.
  Eigen::ConjugateGradient<SparseMatrix, Eigen::Lower | Eigen::Upper, Eigen::IncompleteCholesky<double>> gradients;
  gradients.setTolerance(kResidual);
  gradients.compute(stiffness);
  const Eigen::VectorXd u = gradients.solve(load);
  if (gradients.info() != Eigen::Success)
    return tl::unexpected(Diagnostic{.error = fail(Errc::internal, "R-FEM-7").value(), .remedy = "Fix more vertices."});
  return load.dot(u);
}

}  // namespace tactus::sim::study
