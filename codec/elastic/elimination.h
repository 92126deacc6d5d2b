// SPDX-License-Identifier: Apache-2.0
/// In which order the vertices of an elastic body are eliminated, and how long the rows of its matrix are: reverse Cuthill and McKee.
/// spec/55-elastic.md section 3.2. Internal to the library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <tactus/scene/scene_objects.h>

namespace tactus {

struct Elimination {
  static constexpr std::uint32_t kFixed = 0xffffffff;
  std::vector<std::uint32_t> order;  ///< free vertices
  std::vector<std::uint32_t> place;  ///< by vertex: its index in `order`; kFixed
  std::vector<std::uint32_t> first;  ///< by place: the lowest place that shares a tetrahedron with it
};

/// in   vertices  of the object and inner ones.   pre  corners and fixed vertices exist.   time O(tets log tets); allocates
Elimination elimination(const ElasticBody& body, std::size_t vertices);

/// Work of factoring the matrix. spec/20-scene.md section 9
std::uint64_t elastic_work(const Elimination& elimination) noexcept;

}  // namespace tactus
