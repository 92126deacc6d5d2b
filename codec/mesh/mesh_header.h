// SPDX-License-Identifier: Apache-2.0
/// Meshes in a stream header. spec/60-mesh.md section 2. Internal to the library.
#pragma once

#include "codec/base/bytes.h"
#include "codec/base/result.h"
#include "codec/mesh/mesh_object.h"

namespace tactus {

/// The rule that a mesh breaks, or null; names are checked by the header.
const char* broken_mesh_rule(const MeshObject& mesh) noexcept;

/// pre  the mesh breaks no rule.
void write_mesh(ByteWriter& out, const MeshObject& mesh);

/// How much of the limits the meshes before have left.
struct MeshRoom {
  std::uint64_t vertices = 0, triangles = 0;
};

/// Allocates in proportion to the bytes that are there.
/// err  truncated, malformed R-STR-5; unsupported R-MES-2; invalid R-MES-3..7; limit_exceeded R-STR-14: more than there is room for.
Result<MeshObject> parse_mesh(ByteReader& in, const MeshRoom& room);

}  // namespace tactus
