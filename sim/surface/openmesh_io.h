// SPDX-License-Identifier: Apache-2.0
/// OpenMesh behind one function: no exception leaves it and nothing of it reaches the terminal. It writes only: its readers keep coordinates in
/// single precision and drop what does not fit their half-edges.
#pragma once

#include <string>

#include <tactus/base/tri_mesh.h>

namespace tactus::sim {

/// in   format  ".obj", ".ply", ".off", ".stl"
/// err  the reason, in a few words
tl::expected<std::string, std::string> openmesh_write(const TriMesh& mesh, const std::string& format);

}  // namespace tactus::sim
