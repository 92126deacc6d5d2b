// SPDX-License-Identifier: Apache-2.0
/// Surface files of rigid objects. Apart, so that a build without the component SURFACE says so and needs no part of it.
#pragma once

#include <string>

#include <tactus/base/result.h>
#include <tactus/base/tri_mesh.h>

namespace tactus::sim {

/// A closed surface and its centre of mass at constant density [m].
struct ObjectSurface {
  TriMesh mesh;
  Vec3 centre;
};

/// Why it cannot be used, in words with file, place, rule and remedy.
struct ObjectSurfaceError {
  Errc code;
  std::string text;
};

/// err  R-SRF-n, R-TGN-2, 4, 8; unsupported: this build reads no surface files
tl::expected<ObjectSurface, ObjectSurfaceError> read_object_surface(const std::string& file);

}  // namespace tactus::sim
