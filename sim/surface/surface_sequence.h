// SPDX-License-Identifier: Apache-2.0
/// A mesh that moves, as a folder of surface files: one per frame, in the order of the numbers in their names ("f2" before "f10"), the
/// first is the shape at rest. Files of other kinds in the folder do not matter.
///
/// rule      class        broken when
/// R-SEQ-1   io           the folder cannot be read
/// R-SEQ-2   invalid      it holds no surface file, or such of more than one format
/// R-SEQ-3   unsupported  the files are STL, which does not say which vertex is which
/// R-SEQ-4   invalid      a frame has another number of vertices than the first, or other faces
/// R-SRF-n                a file is broken, see surface_file.h; triangles without area are refused in the first frame only
#pragma once

#include <span>
#include <string>
#include <vector>

#include <tactus/base/tri_mesh.h>

namespace tactus::sim {

class SurfaceSequence {
 public:
  /// Find the files and read the first.   err  R-SEQ-1..3, R-SRF-n
  static tl::expected<SurfaceSequence, Diagnostic> open(const std::string& folder);

  std::size_t size() const noexcept { return files_.size(); }
  const TriMesh& rest() const noexcept { return rest_; }
  /// Positions of the vertices of rest(), [file's unit].   pre  frame < size().   err  R-SEQ-4, R-SRF-n
  tl::expected<std::vector<Vec3>, Diagnostic> positions(std::size_t frame) const;

 private:
  std::vector<std::string> files_;
  std::vector<std::vector<std::uint32_t>> polygons_;  // of the first file
  std::size_t vertices_ = 0;                          // of the first file
  std::vector<std::uint32_t> used_;                   // which of them rest_ has
  TriMesh rest_;
};

/// Numbers in the names compare by value.
bool natural_less(const std::string& a, const std::string& b) noexcept;

}  // namespace tactus::sim
