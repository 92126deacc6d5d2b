// SPDX-License-Identifier: Apache-2.0
/// What several declaration elements share: their rules and the syntax of vertices. Internal to the library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/base/rule.h>
#include <tactus/scene/scene.h>

namespace tactus {

// ==== scene rules ====
// Rules of a scene declaration that are checked while it is read, one element at a time.

inline constexpr std::size_t kMaxDeformables = 255;  ///< packets name them by a byte

/// 1..255 bytes of UTF-8 without control characters.
bool is_name(std::string_view name) noexcept;

/// Class of R-STR-5 after a read failed.
inline Errc class_of_overflow(const ByteReader& in) noexcept { return in.overrun() ? Errc::truncated : Errc::malformed; }

/// The first rule that an element breaks, or none. Names that occur twice are found by check_scene().
RuleName broken_object_rule(const RigidObject& object) noexcept;
RuleName broken_parameter_rule(const SceneSpec& spec) noexcept;
RuleName broken_deformable_rule(const DeformableObject& object) noexcept;
RuleName broken_part_rule(const SceneSpec& spec) noexcept;  ///< of loads, motion constants, driven objects, interest

// ==== vertex syntax ====
// Vertices in a scene declaration: where they rest, and which of them are fixed. spec/50-deformable.md section 1.2.

/// Ascending, each below `vertices`.
inline bool are_runs(std::span<const std::uint32_t> list, std::size_t vertices) noexcept {
  for (std::size_t i = 0; i < list.size(); ++i)
    if (list[i] >= vertices || (i > 0 && list[i] <= list[i - 1])) return false;
  return true;
}

/// in   rule  that of a run which leaves the vertices, or follows the one before at once
/// err  truncated, malformed R-STR-5; invalid `rule`
inline Result<std::vector<std::uint32_t>> parse_runs(ByteReader& in, std::uint64_t vertices, RuleName rule) {
  const std::uint64_t runs = in.varint();
  if (!in.ok()) return fail(class_of_overflow(in), "R-STR-5", in.bit_offset());
  if (runs > in.remaining() / 2) return fail(Errc::truncated, "R-STR-5", in.bit_offset());
  std::vector<std::uint32_t> out;
  std::uint64_t end = 0;
  for (std::uint64_t r = 0; r < runs; ++r) {
    const std::uint64_t gap = in.varint(), more = in.varint();
    if (!in.ok()) return fail(class_of_overflow(in), "R-STR-5", in.bit_offset());
    if ((r > 0 && gap == 0) || gap >= vertices - end || more >= vertices - end - gap)
      return fail(Errc::invalid, rule, in.bit_offset());
    for (std::uint64_t v = end + gap; v <= end + gap + more; ++v) out.push_back(static_cast<std::uint32_t>(v));
    end += gap + more + 1;
  }
  return out;
}

/// pre  are_runs()
inline void write_runs(ByteWriter& out, std::span<const std::uint32_t> list) {
  const auto begins = [&](std::size_t i) { return i == 0 || list[i] != list[i - 1] + 1; };
  std::size_t runs = 0;
  for (std::size_t i = 0; i < list.size(); ++i) runs += begins(i) ? 1u : 0u;
  out.varint(runs);
  for (std::size_t i = 0, end = 0; i < list.size();) {
    const std::size_t first = i++;
    while (i < list.size() && !begins(i)) ++i;
    out.varint(list[first] - end);
    out.varint(i - first - 1);
    end = list[i - 1] + std::size_t{1};
  }
}

/// A position as a difference from the one before it.
/// err  invalid R-DEF-5 a coordinate leaves 32 bits; truncated, malformed R-STR-5
Result<void> parse_positions(ByteReader& in, std::uint64_t count, std::vector<std::array<std::int32_t, 3>>& out);
void write_positions(ByteWriter& out, std::span<const std::array<std::int32_t, 3>> positions);

}  // namespace tactus
