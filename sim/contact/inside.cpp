// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/contact/inside.h>

#include <cmath>

namespace tactus::sim {
namespace {

constexpr std::uint32_t kNone = MeshTopology::kNone;

Vec3 unit(const Vec3& v) {
  const double length = norm(v);
  return length > 0 ? (1 / length) * v : Vec3{};
}

double angle(const Vec3& a, const Vec3& b) { return std::atan2(norm(cross(a, b)), dot(a, b)); }

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
