// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/scene/toml_reader.h>

#include <algorithm>

namespace tactus::sim {

namespace {

/// Bytes of the string at the front of `text`. It ends with its line at the latest, unless it is in three quotes.
std::size_t string_length(std::string_view text) noexcept {
  const char quote = text[0];
  const bool is_long = text.size() > 2 && text[1] == quote && text[2] == quote;
  std::size_t at = is_long ? 3 : 1, quotes = 0;
  for (; at < text.size() && (is_long ? quotes < 3 : quotes < 1); ++at) {
    if (!is_long && text[at] == '\n') return at;
    quotes = text[at] == quote ? quotes + 1 : 0;
    if (text[at] == '\\' && quote == '"') ++at;
  }
  at = std::min(at, text.size());
  for (int more = 0; is_long && more < 2 && at < text.size() && text[at] == quote; ++more) ++at;  // quotes before the last three
  return at;
}

}  // namespace

std::optional<std::uint32_t> too_nested_line(std::string_view text) noexcept {
  std::uint32_t line = 1;
  std::size_t brackets = 0, parts = 1;
  while (!text.empty()) {
    std::size_t length = 1;
    switch (text[0]) {
      case '#':
        length = std::min(text.find('\n'), text.size());
        break;
      case '"':
      case '\'':
        length = string_length(text);
        break;
      case '.':
        ++parts;
        break;
      case '[':
      case '{':
        ++brackets;
        parts = 1;
        break;
      case ']':
      case '}':
        brackets -= brackets > 0 ? 1 : 0;
        parts = 1;
        break;
      case '\n':
      case ',':
      case '=':
        parts = 1;
        break;
      default:
        break;
    }
    if (parts > kMostTomlNesting || brackets > kMostTomlNesting) return line;
    line += static_cast<std::uint32_t>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(length), '\n'));
    text.remove_prefix(length);
  }
  return std::nullopt;
}

}  // namespace tactus::sim
