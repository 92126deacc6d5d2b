// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/rigid/collision.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace tactus::sim {

// ==== box tree ====

void BoxTree::reserve(std::size_t count) {
  items_.reserve(count);
  nodes_.reserve(count + 1);  // a leaf holds at least two, unless it is the root
}

void BoxTree::build() {
  nodes_.clear();
  if (!items_.empty()) split(0, static_cast<std::uint32_t>(items_.size()));
}

void BoxTree::split(std::uint32_t first, std::uint32_t last) {
  Extent around = items_[first].bounds;
  for (std::uint32_t i = first + 1; i < last; ++i) {
    const Extent& box = items_[i].bounds;
    around.low = {std::min(around.low.x, box.low.x), std::min(around.low.y, box.low.y), std::min(around.low.z, box.low.z)};
    around.high = {std::max(around.high.x, box.high.x), std::max(around.high.y, box.high.y), std::max(around.high.z, box.high.z)};
  }
  const std::size_t node = nodes_.size();
  nodes_.push_back({around, first, last - first, node + 1});
  if (last - first <= kLeafSize) return;
  const Vec3 size = around.high - around.low;
  double Vec3::*const axis = size.x >= size.y && size.x >= size.z ? &Vec3::x : size.y >= size.z ? &Vec3::y : &Vec3::z;
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(items_.begin() + first, items_.begin() + middle, items_.begin() + last, [axis](const Item& a, const Item& b) {
    return std::pair(a.bounds.low.*axis + a.bounds.high.*axis, a.number) <
           std::pair(b.bounds.low.*axis + b.bounds.high.*axis, b.number);
  });
  nodes_[node].count = 0;
  split(first, middle);
  split(middle, last);
  nodes_[node].skip = nodes_.size();
}

// ==== ode mesh ====

namespace {

double distance2(const dContact& a, const dContact& b) noexcept {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += (a.geom.pos[k] - b.geom.pos[k]) * (a.geom.pos[k] - b.geom.pos[k]);
  return sum;
}

}  // namespace

OdeMesh make_ode_mesh(const TriMesh& mesh) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(dTriIndex));
  OdeMesh data(dGeomTriMeshDataCreate());
  dGeomTriMeshDataBuildDouble(data.get(), mesh.vertices.data(), sizeof(Vec3), static_cast<int>(mesh.vertices.size()),
                              mesh.triangles.data(), static_cast<int>(3 * mesh.triangles.size()), sizeof(Triangle));
  return data;
}

dMass mass_of_mesh(dGeomID geom, double mass) {
  dMass out;
  dMassSetTrimeshTotal(&out, mass, geom);
  dMassTranslate(&out, -out.c[0], -out.c[1], -out.c[2]);  // rounding error of the centre
  return out;
}

int keep_outermost(std::span<dContact> contacts, int most) noexcept {
  const auto count = std::min(contacts.size(), static_cast<std::size_t>(most));
  if (count == contacts.size()) return static_cast<int>(count);
  std::iter_swap(contacts.begin(), std::max_element(contacts.begin(), contacts.end(),
                                                    [](auto& a, auto& b) { return a.geom.depth < b.geom.depth; }));
  for (std::size_t kept = 1; kept < count; ++kept) {
    std::size_t farthest = kept;
    double largest = -1;
    for (std::size_t i = kept; i < contacts.size(); ++i) {
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < kept; ++k) nearest = std::min(nearest, distance2(contacts[i], contacts[k]));
      if (nearest > largest) largest = nearest, farthest = i;
    }
    std::swap(contacts[kept], contacts[farthest]);
  }
  return static_cast<int>(count);
}

}  // namespace tactus::sim
