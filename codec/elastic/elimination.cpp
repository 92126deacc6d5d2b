// SPDX-License-Identifier: Apache-2.0
#include <tactus/elastic/elimination.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include <tactus/base/tri_mesh.h>

namespace tactus {
namespace {

/// For each free vertex the other free ones that share a tetrahedron with it, ascending.
ListOfLists<std::uint32_t> neighbours(const ElasticBody& body, const std::vector<std::uint8_t>& is_free) {
  std::vector<std::uint64_t> pairs;
  for (const ElasticBody::Tet& tet : body.tets)
    for (const std::uint32_t a : tet)
      for (const std::uint32_t b : tet)
        if (a != b && is_free[a] != 0 && is_free[b] != 0) pairs.push_back(std::uint64_t{a} << 32 | b);
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  ListOfLists<std::uint32_t> out;
  out.items.reserve(pairs.size());
  auto pair = pairs.begin();
  for (std::uint64_t v = 0; v < is_free.size(); ++v) {
    for (; pair != pairs.end() && *pair >> 32 == v; ++pair) out.items.push_back(static_cast<std::uint32_t>(*pair));
    out.close();
  }
  return out;
}

/// Breadth first, those with few neighbours first.
class Walk {
 public:
  Walk(const ListOfLists<std::uint32_t>& near, std::size_t vertices) : near_(near), seen_in_(vertices, 0) {}

  /// All that is connected with `start`, which comes first.
  void from(std::uint32_t start, std::vector<std::uint32_t>& out) {
    ++walks_;
    out.assign(1, start);
    seen_in_[start] = walks_;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const std::size_t found = out.size();
      for (const std::uint32_t v : near_[out[i]]) {
        if (seen_in_[v] == walks_) continue;
        seen_in_[v] = walks_;
        out.push_back(v);
      }
      const auto key = [this](std::uint32_t v) { return std::pair(near_[v].size(), v); };
      std::ranges::sort(out.begin() + static_cast<std::ptrdiff_t>(found), out.end(), {}, key);
    }
  }

 private:
  const ListOfLists<std::uint32_t>& near_;
  std::vector<std::uint32_t> seen_in_;  // number of a walk
  std::uint32_t walks_ = 0;
};

}  // namespace

Elimination elimination(const ElasticBody& body, std::size_t vertices) {
  std::vector<std::uint8_t> is_free(vertices, 1);
  for (const std::uint32_t v : body.fixed) is_free[v] = 0;
  const ListOfLists<std::uint32_t> near = neighbours(body, is_free);
  Elimination out{.order = {}, .place = std::vector<std::uint32_t>(vertices, Elimination::kFixed), .first = {}};
  Walk walk(near, vertices);
  std::vector<std::uint32_t> part;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    if (is_free[v] == 0 || out.place[v] != Elimination::kFixed) continue;
    walk.from(v, part);
    walk.from(part.back(), part);
    for (const std::uint32_t w : part) out.place[w] = 0;
    out.order.insert(out.order.end(), part.begin(), part.end());
  }
  std::ranges::reverse(out.order);
  for (std::uint32_t i = 0; i < out.order.size(); ++i) out.place[out.order[i]] = i;
  out.first.resize(out.order.size());
  for (std::uint32_t i = 0; i < out.order.size(); ++i) {
    out.first[i] = i;
    for (const std::uint32_t v : near[out.order[i]]) out.first[i] = std::min(out.first[i], out.place[v]);
  }
  return out;
}

std::uint64_t elastic_work(const Elimination& elimination) noexcept {
  constexpr std::uint64_t kLargest = std::uint64_t{1} << 54;
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < elimination.first.size(); ++i) {
    for (std::uint64_t axis = 0; axis < 3; ++axis) {
      const std::uint64_t width = 3 * (i - elimination.first[i]) + axis;
      sum = std::min(sum + (width + 64) * (width + 64), kLargest);
    }
  }
  return sum;
}

}  // namespace tactus
