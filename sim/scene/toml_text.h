// SPDX-License-Identifier: Apache-2.0
/// What a TOML file may cost, looked at before it is parsed: the parser calls itself once for every table in a table, however it is
/// written, and parts of a dotted key are not among what it limits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace tactus::sim {

inline constexpr std::size_t kMostTomlNesting = 32;  ///< parts of one dotted key; brackets within brackets

/// The first line with a dotted key of more parts, or within more brackets, than that. Strings and comments are skipped as TOML 1.0
/// writes them; of what is no TOML at all, up to its first mistake.   time O(size), no allocation
std::optional<std::uint32_t> too_nested_line(std::string_view text) noexcept;

}  // namespace tactus::sim
