// SPDX-License-Identifier: Apache-2.0
/// Checks what a surface file announces, before OpenMesh reads it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <tactus/base/tri_mesh.h>

namespace tactus::sim {

struct SurfaceText {
  std::string text;       ///< what OpenMesh may read: comments, materials, textures and normals left out where they can be
  std::string format;     ///< what OpenMesh calls it
  std::size_t faces = 0;  ///< in the file
  std::optional<std::size_t> vertices;  ///< in the file; none: STL, whose corners are merged
};

/// err  R-SRF-2, R-SRF-3, R-SRF-4
tl::expected<SurfaceText, Diagnostic> prepare_surface(std::string_view text, std::string_view format);

}  // namespace tactus::sim
