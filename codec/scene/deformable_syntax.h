// SPDX-License-Identifier: Apache-2.0
/// Deformable objects in a scene declaration. spec/60-object.md section 2. Internal to the library.
#pragma once

#include <tactus/base/bytes.h>
#include <tactus/base/result.h>
#include <tactus/scene/deformable_object.h>

namespace tactus {

/// pre  the object breaks no rule.
void write_deformable(ByteWriter& out, const DeformableObject& object);

/// What the preceding objects have left of the limits.
struct DeformableRoom {
  std::uint64_t vertices = 0, triangles = 0;
};

/// Allocates in proportion to the bytes received.
/// err  truncated, malformed R-STR-5; unsupported R-DEF-2; invalid R-DEF-3..7; limit_exceeded R-STR-14: more than the limits
///      leave.
Result<DeformableObject> parse_deformable(ByteReader& in, const DeformableRoom& room);

}  // namespace tactus
