// SPDX-License-Identifier: Apache-2.0
/// The clusters of a trace's meshes: a basis for bodies that turn and walk.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include <tactus/base/result.h>
#include <tactus/scene/scene_objects.h>
#include <tactus/trace/trace_file.h>

namespace tactus {

/// Reads the whole trace and finds the clusters of each mesh that moves, by name, on shapes that are spread over it evenly.
/// err  those of the reader and of motion_clusters()
/// time of reading, and that of motion_clusters() for up to twice kClusterShapes shapes, fewer of a mesh of more than 100 000 vertices
Result<std::map<std::string, ClusterBasis>> find_clusters(TraceReader& reader, std::size_t count);

}  // namespace tactus
