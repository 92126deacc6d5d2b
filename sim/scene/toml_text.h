// SPDX-License-Identifier: Apache-2.0
/// Limits the nesting of a TOML file before it is parsed. The parser recurses for every nested table, in any notation, and does
/// not limit the parts of a dotted key.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace tactus::sim {

inline constexpr std::size_t kMostTomlNesting = 32;  ///< parts of one dotted key; brackets within brackets

/// The first line that exceeds this limit. Strings and comments are skipped by the rules of TOML 1.0; text that is not TOML is
/// checked up to its first mistake.   time O(size), no allocation
std::optional<std::uint32_t> too_nested_line(std::string_view text) noexcept;

}  // namespace tactus::sim
