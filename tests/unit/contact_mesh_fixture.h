// SPDX-License-Identifier: Apache-2.0
/// Meshes to touch.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include <tactus/base/tri_mesh.h>
#include <tactus/sim/contact/aabb_tree.h>
#include <tactus/sim/random.h>

namespace tactus::testing {

/// A mesh with what contact needs beside it.
struct Body {
  TriMesh mesh;
  MeshTopology topology{mesh};
  sim::AabbTree tree{mesh};
  sim::InsideTest inside{mesh, topology};

  explicit Body(TriMesh made) : mesh(std::move(made)) {}
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;
  double extent() const {
    double out = 0;
    for (const Vec3& v : mesh.vertices) out = std::max({out, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    return out;
  }
};

/// n x n squares around the origin, z = height(x, y), normals up.
template <class Height>
TriMesh sheet(std::uint32_t n, double cell, Height&& height) {
  TriMesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = cell * (i - 0.5 * n), y = cell * (j - 0.5 * n);
      mesh.vertices.push_back({x, y, height(x, y)});
    }
  }
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

/// Height of a mesh made by sheet() at a point: of the very triangle there.
inline double sheet_height(const TriMesh& mesh, std::uint32_t n, double cell, double x, double y) {
  const auto index = [&](double v) { return std::clamp(std::floor(v / cell + 0.5 * n), 0.0, n - 1.0); };
  const double i = index(x), j = index(y);
  const auto a = static_cast<std::uint32_t>(j * (n + 1) + i);
  const Vec3 &va = mesh.vertices[a], &vd = mesh.vertices[a + n + 2];
  const double u = (x - va.x) / cell, w = (y - va.y) / cell;
  const double za = va.z, zd = vd.z, zb = mesh.vertices[a + 1].z, zc = mesh.vertices[a + n + 1].z;
  return u >= w ? za + u * (zb - za) + w * (zd - zb) : za + w * (zc - za) + u * (zd - zc);
}

/// Sphere around the origin: an octahedron halved `times` times, 8 * 4^times triangles.
inline TriMesh ball(double radius, unsigned times) {
  TriMesh mesh;
  mesh.vertices = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2}, {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
  for (unsigned round = 0; round < times; ++round) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [it, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) {
        const Vec3 sum = mesh.vertices[a] + mesh.vertices[b];
        mesh.vertices.push_back((1 / norm(sum)) * sum);
      }
      return it->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& v : mesh.vertices) v = radius * v;
  return mesh;
}

/// Box around the origin, two triangles per face.
inline TriMesh box(const Vec3& half) {
  TriMesh mesh;
  for (unsigned i = 0; i < 8; ++i) {
    mesh.vertices.push_back({i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z});
  }
  for (const auto& [a, b, c, d] :
       {std::array{0u, 2u, 3u, 1u}, {4u, 5u, 7u, 6u}, {0u, 1u, 5u, 4u}, {2u, 6u, 7u, 3u}, {0u, 4u, 6u, 2u}, {1u, 3u, 7u, 5u}}) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  return mesh;
}

/// The same surface seen from the other side.
inline TriMesh inside_out(TriMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

/// Bumps of all sizes on a sphere, up to `fraction` of its radius.
inline TriMesh bumpy_ball(double radius, unsigned times, double fraction, std::uint64_t seed) {
  TriMesh mesh = ball(radius, times);
  sim::Random random(seed);
  std::array<Vec3, 12> waves;
  for (Vec3& wave : waves) wave = {random.uniform(-30, 30), random.uniform(-30, 30), random.uniform(-30, 30)};
  for (Vec3& v : mesh.vertices) {
    double sum = random.uniform(-0.02, 0.02);
    for (const Vec3& wave : waves) sum += std::sin(dot(wave, (1 / radius) * v)) / 12;
    v = (1 + fraction * sum) * v;
  }
  return mesh;
}

template <class T>
void shuffle(std::vector<T>& items, sim::Random& random) {
  for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[random.next() % i]);
}

/// The same mesh with vertices, triangles and the first corners of triangles in another order.
inline TriMesh renumbered(const TriMesh& mesh, std::uint64_t seed) {
  sim::Random random(seed);
  std::vector<std::uint32_t> target(mesh.vertices.size());
  std::iota(target.begin(), target.end(), 0u);
  shuffle(target, random);
  TriMesh out{std::vector<Vec3>(mesh.vertices.size()), mesh.triangles};
  for (std::size_t i = 0; i < target.size(); ++i) out.vertices[target[i]] = mesh.vertices[i];
  for (Triangle& t : out.triangles) {
    for (std::uint32_t& v : t) v = target[v];
    std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(random.next() % 3), t.end());
  }
  shuffle(out.triangles, random);
  return out;
}

inline Vec3 random_point(sim::Random& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
}

}  // namespace tactus::testing
