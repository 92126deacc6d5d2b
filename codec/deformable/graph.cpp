// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/graph.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include <tactus/deformable/coding_order.h>
#include <tactus/deformable/kriging.h>

namespace tactus {
namespace {

using Pair = std::array<std::uint32_t, 2>;

/// Consecutive ones among the vertices at one rest position. Programs split a vertex where texture or normals jump: the copies have
/// no triangle in common, but move together.
std::vector<Pair> seams(const DeformableObject& object) {
  struct Place {
    std::uint64_t xy, z_vertex;
  };
  const auto bits = [](std::int32_t c) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(c)); };
  std::vector<Place> places;
  places.reserve(object.rest.size());
  for (std::size_t v = 0; v < object.rest.size(); ++v)
    places.push_back({bits(object.rest[v][0]) << 32 | bits(object.rest[v][1]), bits(object.rest[v][2]) << 32 | v});
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return a.xy != b.xy ? a.xy < b.xy : a.z_vertex < b.z_vertex; });
  std::vector<Pair> out;
  for (std::size_t i = 1; i < places.size(); ++i) {
    const Place &a = places[i - 1], &b = places[i];
    if (a.xy == b.xy && a.z_vertex >> 32 == b.z_vertex >> 32)
      out.push_back({static_cast<std::uint32_t>(a.z_vertex), static_cast<std::uint32_t>(b.z_vertex)});
  }
  return out;
}

/// Lists from pairs (list, item) that `visit` hands out twice, in the same order.
template <class Visit>
ListOfLists<std::uint32_t> lists_of(std::size_t lists, Visit visit) {
  ListOfLists<std::uint32_t> out;
  out.first.assign(lists + 1, 0);
  visit([&](std::uint32_t list, std::uint32_t) { ++out.first[list + 1]; });
  for (std::size_t i = 0; i < lists; ++i) out.first[i + 1] += out.first[i];
  out.items.resize(out.first[lists]);
  std::vector<std::uint32_t> next(out.first.begin(), out.first.end() - 1);
  visit([&](std::uint32_t list, std::uint32_t item) { out.items[next[list]++] = item; });
  return out;
}

/// Every list ascending and without repetition.
void tidy(Neighbours& lists) {
  std::uint32_t kept = 0, begin = 0;
  for (std::size_t i = 0; i < lists.size(); ++i) {
    const std::uint32_t end = lists.first[i + 1];
    const auto from = lists.items.begin() + begin, to = lists.items.begin() + end;
    std::sort(from, to);
    const auto last = std::unique(from, to);
    std::move(from, last, lists.items.begin() + kept);
    kept += static_cast<std::uint32_t>(last - from);
    lists.first[i + 1] = kept;
    begin = end;
  }
  lists.items.resize(kept);
}

}  // namespace

Neighbours neighbours(const DeformableObject& object) {
  const std::vector<Pair> copies = seams(object);
  Neighbours out = lists_of(object.rest.size(), [&](auto add) {
    const auto edge = [&](std::uint32_t a, std::uint32_t b) {
      add(a, b);
      add(b, a);
    };
    for (const auto& [a, b] : copies) edge(a, b);
    for (const Triangle& t : object.triangles)
      for (std::size_t k = 0; k < 3; ++k) edge(t[k], t[(k + 1) % 3]);
  });
  tidy(out);
  return out;
}

VertexHierarchy vertex_hierarchy(const DeformableObject& object) {
  CodingOrder order = coding_order(object);
  std::vector<ListOfLists<VertexParent>> parents;
  for (unsigned set = 0; set < DeformableObject::kWeightSets; ++set)
    if (object.weight_sets >> set & 1) parents.push_back(weighted_parents(object, order, set));
  return {std::move(order.order), std::move(order.depth), std::move(parents)};
}

Rings::Rings(const DeformableObject& object)
    : corners_(object.triangles), triangle_mark_(object.triangles.size()), vertex_mark_(object.rest.size()) {
  triangles_of_ = lists_of(object.rest.size(), [&](auto add) {
    for (std::uint32_t t = 0; t < object.triangles.size(); ++t)
      for (const std::uint32_t v : object.triangles[t]) add(v, t);
  });
  triangles_.reserve(object.triangles.size());
  vertices_.reserve(object.rest.size());
}

void Rings::add_corners(std::uint32_t triangle) noexcept {
  for (const std::uint32_t v : corners_[triangle]) {
    if (vertex_mark_[v] == mark_) continue;
    vertex_mark_[v] = mark_;
    vertices_.push_back(v);
  }
}

std::span<const std::uint32_t> Rings::triangles_around(std::uint32_t triangle, std::uint32_t rings) noexcept {
  if (++mark_ == 0) {
    std::fill(triangle_mark_.begin(), triangle_mark_.end(), 0u);
    std::fill(vertex_mark_.begin(), vertex_mark_.end(), 0u);
    mark_ = 1;
  }
  triangles_.clear();
  vertices_.clear();
  triangles_.push_back(triangle);
  triangle_mark_[triangle] = mark_;
  add_corners(triangle);
  std::size_t grown = 0;  // vertices whose triangles are all in
  for (std::uint32_t r = 0; r < rings; ++r) {
    const std::size_t rim = vertices_.size(), inner = triangles_.size();
    for (; grown < rim; ++grown) {
      for (const std::uint32_t t : triangles_of_[vertices_[grown]]) {
        if (triangle_mark_[t] == mark_) continue;
        triangle_mark_[t] = mark_;
        triangles_.push_back(t);
      }
    }
    for (std::size_t i = inner; i < triangles_.size(); ++i) add_corners(triangles_[i]);
  }
  return triangles_;
}

}  // namespace tactus
