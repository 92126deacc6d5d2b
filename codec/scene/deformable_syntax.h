// SPDX-License-Identifier: Apache-2.0
/// Deformable objects in a scene declaration. spec/50-deformable.md sections 1.2 and 1.6. Internal to the library.
#pragma once

#include <cstdint>
#include <span>

#include <tactus/base/bytes.h>
#include <tactus/base/result.h>
#include <tactus/scene/scene_objects.h>

namespace tactus {

/// pre  the object breaks no rule.
void write_deformable(ByteWriter& out, const DeformableObject& object);

/// What the preceding objects have left of the limits, and which profiles there are.
struct DeformableRoom {
  std::uint64_t vertices = 0, triangles = 0;
  bool has_thesis = false;
};

/// Allocates in proportion to the bytes received.
/// err  truncated, malformed R-STR-5; unsupported R-DEF-2; invalid R-DEF-3..7; limit_exceeded R-STR-14: more than the limits
///      leave.
Result<DeformableObject> parse_deformable(ByteReader& in, const DeformableRoom& room);

inline constexpr std::uint64_t kStiffnessRecord = 3;  ///< type of the extension record

/// The whole record.   pre  the object declares its stiffness
void write_stiffness(ByteWriter& out, std::uint8_t object, const DeformableObject& of);
/// Into the object that the record names.
/// in   in  the record's data; bytes after the known elements are skipped
/// err  truncated, invalid R-STR-20
Result<void> parse_stiffness(ByteReader& in, std::span<DeformableObject> objects);

}  // namespace tactus
