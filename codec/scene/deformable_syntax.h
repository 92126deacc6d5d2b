// SPDX-License-Identifier: Apache-2.0
/// Meshes in a stream header. spec/60-mesh.md section 2. Internal to the library.
#pragma once

#include <tactus/base/bytes.h>
#include <tactus/base/result.h>
#include <tactus/scene/deformable_object.h>

namespace tactus {

/// The rule that a mesh breaks, or null; names are checked by the header.
const char* broken_deformable_rule(const DeformableObject& mesh) noexcept;

/// pre  the mesh breaks no rule.
void write_deformable(ByteWriter& out, const DeformableObject& mesh);

/// How much of the limits the meshes before have left.
struct DeformableRoom {
  std::uint64_t vertices = 0, triangles = 0;
};

/// Allocates in proportion to the bytes that are there.
/// err  truncated, malformed R-STR-5; unsupported R-MES-2; invalid R-MES-3..7; limit_exceeded R-STR-14: more than there is room for.
Result<DeformableObject> parse_deformable(ByteReader& in, const DeformableRoom& room);

}  // namespace tactus
