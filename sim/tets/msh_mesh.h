// SPDX-License-Identifier: Apache-2.0
/// What both readers of .msh, of text and of bytes, make: vertices by their numbers, tetrahedra, and what is left out. Internal to the library.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <tactus/sim/tets/tet_files.h>

namespace tactus::sim {

constexpr std::size_t kMshTet = 4;  ///< Gmsh's number of the linear tetrahedron

/// How many nodes an element of Gmsh's type has; 0: unknown.
constexpr std::size_t msh_nodes(std::size_t type) noexcept {
  constexpr std::array<std::uint8_t, 32> kNodes{0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                                                8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};
  return type < kNodes.size() ? kNodes[type] : 0;
}
constexpr bool is_curved_tet(std::size_t type) noexcept { return type == 11 || (type >= 29 && type <= 31); }

struct MshMesh {
  TetFile file;
  std::vector<std::pair<std::size_t, std::uint32_t>> tags;  ///< a vertex's number in the file, its index in the mesh

  void reserve(std::size_t count) {
    file.mesh.vertices.reserve(count);
    tags.reserve(count);
  }
  void add_tag(std::size_t tag) { tags.emplace_back(tag, static_cast<std::uint32_t>(tags.size())); }
  /// out  a number that is there twice
  std::optional<std::size_t> sort_tags() {
    std::sort(tags.begin(), tags.end());
    const auto twice =
        std::adjacent_find(tags.begin(), tags.end(), [](const auto& a, const auto& b) { return a.first == b.first; });
    if (twice == tags.end()) return std::nullopt;
    return twice->first;
  }
  /// pre  sort_tags()
  std::optional<std::uint32_t> vertex(std::size_t tag) const {
    const auto found = std::lower_bound(tags.begin(), tags.end(), std::pair{tag, std::uint32_t{0}});
    if (found == tags.end() || found->first != tag) return std::nullopt;
    return found->second;
  }
};

/// Leave out vertices of no tetrahedron, such as the centre of a circle, with what belongs to them.   pre  every corner is a vertex
void drop_unused_vertices(TetFile& file);

/// The mesh of a binary file of version 2.2 or 4.1, from the bytes behind its header.
/// in   format  "2.2" or "4.1"   body  what follows the line of the format
tl::expected<TetFile, Diagnostic> parse_binary_msh(std::string_view format, std::string_view body);

}  // namespace tactus::sim
