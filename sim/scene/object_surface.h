// SPDX-License-Identifier: Apache-2.0
/// Surface files of rigid objects. A file of its own, so that a build without the component SURFACE can report that it lacks it.
#pragma once

#include <string>

#include <tactus/base/diagnostic.h>
#include <tactus/base/tri_mesh.h>

namespace tactus::sim {

/// A closed surface and its centre of mass at constant density [m].
struct ObjectSurface {
  TriMesh mesh;
  Vec3 centre;
};

/// err  R-SRF-n, R-TGN-2, 4, 8; unsupported R-SRF-3: this build reads no surface files
tl::expected<ObjectSurface, Diagnostic> read_object_surface(const std::string& file);

}  // namespace tactus::sim
