// SPDX-License-Identifier: Apache-2.0
/// Rules of a scene declaration that are checked while it is read, one element at a time. Internal to the library.
#pragma once

#include <string_view>

#include <tactus/base/bytes.h>
#include <tactus/base/rule.h>
#include <tactus/scene/scene.h>

namespace tactus {

inline constexpr std::size_t kMaxDeformables = 255;  ///< packets name them by a byte

/// 1..255 bytes of UTF-8 without control characters.
bool is_name(std::string_view name) noexcept;

/// Class of R-STR-5 after a read failed.
inline Errc class_of_overflow(const ByteReader& in) noexcept { return in.overrun() ? Errc::truncated : Errc::malformed; }

/// The first rule that an element breaks, or none. Names that occur twice are found by check_scene().
RuleName broken_object_rule(const RigidObject& object) noexcept;
RuleName broken_parameter_rule(const SceneSpec& spec) noexcept;
RuleName broken_deformable_rule(const DeformableObject& object) noexcept;
RuleName broken_load_rule(const SceneSpec& spec) noexcept;
RuleName broken_motion_rule(const SceneSpec& spec) noexcept;
RuleName broken_driven_rule(const SceneSpec& spec) noexcept;

}  // namespace tactus
