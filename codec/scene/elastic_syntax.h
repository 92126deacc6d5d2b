// SPDX-License-Identifier: Apache-2.0
/// Declaration elements with real numbers: elastic bodies and bounds. Internal to the library.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/base/result.h>
#include <tactus/base/rule.h>
#include <tactus/scene/scene.h>
#include <tactus/scene/scene_objects.h>

namespace tactus {

// ==== bounds syntax ====
// The extension record of a scene declaration that holds the stream's bounds. spec/20-scene.md section 6.

inline constexpr std::uint64_t kBoundsRecord = 2;  ///< type of the record

/// R-STR-17: the bounds match the scene's objects, their numbers are finite and carry no sign.   pre  there are bounds
bool are_bounds(const SceneSpec& spec) noexcept;

/// Data of the record.   pre  are_bounds()
std::vector<std::uint8_t> write_bounds(StreamBounds bounds);

/// in   in      the record's data; bytes after the known elements are skipped
///      spec  with its objects
/// err  truncated, invalid R-STR-17
Result<StreamBounds> parse_bounds(ByteReader& in, const SceneSpec& spec);

// ==== elastic syntax ====
// Elastic bodies in a scene declaration. spec/55-elastic.md section 1.1.

bool has_elastic_body(std::span<const DeformableObject> objects) noexcept;

/// The rule that the body of an object breaks, if it has one: R-ELA-1..3.   time O(tets)
/// pre  the rest of the object breaks none
RuleName broken_elastic_rule(const DeformableObject& object) noexcept;
/// Of a body that breaks no other rule: every tetrahedron has a volume, every free vertex a tetrahedron, and there is one (R-ELA-4).
/// time O(tets); allocates
bool is_solid(const DeformableObject& object, unsigned position_exp);

/// Of a body that breaks no other rule: velocity Verlet is stable with its sub-steps (R-ELA-5).   time 1 us per tetrahedron; allocates
bool steps_stably(const DeformableObject& object, unsigned position_exp, std::uint32_t tick_rate);

/// Of all deformable objects.   pre  one has a body
void write_elastic(ByteWriter& out, std::span<const DeformableObject> objects);
/// Allocates in proportion to the bytes received.
/// err  truncated, malformed R-STR-5; malformed, invalid R-ELA-1; invalid R-ELA-2..4, R-DEF-5
Result<void> parse_elastic(ByteReader& in, std::span<DeformableObject> objects, unsigned position_exp);

}  // namespace tactus
