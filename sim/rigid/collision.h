// SPDX-License-Identifier: Apache-2.0
/// What collides in ODE: static boxes in a tree, and solids of any shape. Internal to rigid_world.cpp.
#pragma once

#include <ode/ode.h>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/tri_mesh.h>

namespace tactus::sim {

// ==== box tree ====
// Overlap queries against many static boxes: a tree of boxes, split at the median of the longest side.

/// An axis-aligned box.
struct Extent {
  Vec3 low, high;  ///< [m]
};

inline bool overlap(const Extent& a, const Extent& b) noexcept {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y && a.low.z <= b.high.z &&
         b.low.z <= a.high.z;
}

class BoxTree {
 public:
  struct Item {
    std::uint32_t number = 0;
    Extent bounds;
  };

  /// Reserve memory for so many items; build() then allocates nothing.
  void reserve(std::size_t count);
  void clear() noexcept { items_.clear(); }
  void add(const Item& item) { items_.push_back(item); }
  /// Build the tree over all added items.   time O(n log n)
  void build();
  /// Call visit(number) for every item that overlaps a box, in no particular order.   time O(log n + visits), no allocation
  template <class Visit>
  void visit(const Extent& box, Visit&& visit) const {
    for (std::size_t i = 0; i < nodes_.size();) {
      const Node& node = nodes_[i];
      const bool reaches = overlap(node.bounds, box);
      if (reaches && node.count > 0)
        for (std::uint32_t k = node.first; k < node.first + node.count; ++k)
          if (overlap(items_[k].bounds, box)) visit(items_[k].number);
      i = reaches ? i + 1 : node.skip;
    }
  }

 private:
  static constexpr std::uint32_t kLeafSize = 4;
  struct Node {
    Extent bounds;
    std::uint32_t first = 0, count = 0;  // items of a leaf; count 0: inner node, its children follow
    std::size_t skip = 0;                // node after this subtree
  };
  void split(std::uint32_t first, std::uint32_t last);

  std::vector<Item> items_;
  std::vector<Node> nodes_;  // depth first
};

// ==== ode mesh ====
// Solids of any shape in ODE. Internal to rigid_world.cpp.
//
// They collide as triangle meshes, not as convex hulls: a bracket's inner corner must hold an object that lies in it, and ODE's
// hull-hull test yields a single point where two faces meet. On a mesh ODE finds a contact at every corner and edge, hundreds on
// a fine mesh. A few of them suffice.

struct TriMeshDataEnd {
  void operator()(dTriMeshDataID data) const noexcept { dGeomTriMeshDataDestroy(data); }
};
/// ODE's view of a mesh; the mesh must outlive it and stay where it is.
using OdeMesh = std::unique_ptr<dxTriMeshData, TriMeshDataEnd>;

OdeMesh make_ode_mesh(const TriMesh& mesh);

/// Mass properties of the enclosed solid at constant density, about the origin, which is its centre of mass.
/// in  geom  of the mesh, where it was made
dMass mass_of_mesh(dGeomID geom, double mass);

/// Move the best supporting contacts to the front: the deepest, then repeatedly the one farthest from those chosen.
/// out  their number: at most `most`.   time O(contacts * most)
int keep_outermost(std::span<dContact> contacts, int most) noexcept;

}  // namespace tactus::sim
