// SPDX-License-Identifier: Apache-2.0
/// Strings of untrusted files: UTF-8 as RFC 3629 defines it, and numbers read without a locale.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace tactus {

/// Shortest forms only, no surrogates, nothing above U+10FFFF.
bool is_utf8(std::string_view text) noexcept;

/// Fit for a name that becomes part of a topic and of a column: 1..255 bytes of UTF-8 without '/' and control characters.
bool is_plain_name(std::string_view text) noexcept;

/// The number that all of `text` spells; nothing when characters are left over or the type cannot hold it.
template <class T>
std::optional<T> parse_number(std::string_view text) noexcept {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace tactus
