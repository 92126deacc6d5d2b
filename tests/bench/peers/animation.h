// SPDX-License-Identifier: Apache-2.0
/// What every peer codes: a mesh whose vertices move, on an integer grid.
#pragma once

#include <string>
#include <vector>

#include <tactus/base/fixed.h>
#include <tactus/base/tri_mesh.h>

namespace tactus::peers {

struct Animation {
  std::string name;
  std::vector<Triangle> triangles;
  std::vector<Vec3i> rest;
  std::vector<std::vector<Vec3i>> frames;  ///< positions, grid units
  std::vector<std::vector<Vec3i>> fine;    ///< what they were rounded from, in 1/kFine of a unit
};

inline constexpr int kFineBits = 6, kFine = 1 << kFineBits;
/// What rounding to the grid may cost: half a diagonal of its cells [units].
inline constexpr double kRounding = 0.8660254037844386;

/// The box whose diagonal is 2^bits units of the grid: that of the rest shape, or of all frames together.
enum class GridBox { rest, frames };

///   x.mcap            the first mesh of a trace, at the ticks at which its shape is new
///   x.md3, x.md3:NAME all surfaces of an MD3 model, or one; its first frame is the rest shape
/// At most `limit` frames are taken.   err  why not, for a person
tl::expected<Animation, std::string> read_animation(const std::string& input, GridBox box, unsigned bits, std::size_t limit);

/// The `count` vertices nearest along edges to the one that moves farthest, with the triangles between them; all of it if there are no more.
Animation patch_of(const Animation& whole, std::size_t count);

}  // namespace tactus::peers
