// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/shown.h>

#include <algorithm>
#include <cstdint>

namespace tactus {
namespace {

constexpr std::size_t kMostOfPath = 240;
constexpr std::string_view kCut = "...";

std::uint8_t byte_of(std::string_view text, std::size_t i) noexcept { return static_cast<std::uint8_t>(text[i]); }

/// U+0000 to U+001F, U+007F to U+009F, U+061C, U+200E, U+200F, U+2028 to U+202E, U+2066 to U+2069; U+FFFE and U+FFFF, which no XML may
/// have.   pre  one UTF-8 sequence
bool has_power(std::string_view c) noexcept {
  const std::uint8_t lead = byte_of(c, 0);
  if (c.size() == 1) return lead < 0x20 || lead == 0x7F;
  const std::uint8_t second = byte_of(c, 1);
  if (c.size() == 2) return (lead == 0xC2 && second < 0xA0) || (lead == 0xD8 && second == 0x9C);
  if (c.size() > 3) return false;
  const std::uint8_t third = byte_of(c, 2);
  if (lead != 0xE2) return lead == 0xEF && second == 0xBF && third >= 0xBE;
  if (second == 0x80) return third == 0x8E || third == 0x8F || (third >= 0xA8 && third <= 0xAE);
  return second == 0x81 && third >= 0xA6 && third <= 0xA9;
}

void append_escaped(std::string& out, std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  for (std::size_t i = 0; i < bytes.size(); ++i)
    out.append("\\x").append(1, kDigits[byte_of(bytes, i) >> 4]).append(1, kDigits[byte_of(bytes, i) & 15]);
}

}  // namespace

std::size_t utf8_length(std::string_view text) noexcept {
  const std::uint8_t lead = byte_of(text, 0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead < 0xC2 ? 0 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : lead < 0xF5 ? 4 : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte_of(text, i) & 0xC0) != 0x80) return 0;
  const std::uint8_t second = byte_of(text, 1);
  const bool overlong = (lead == 0xE0 && second < 0xA0) || (lead == 0xF0 && second < 0x90);
  const bool surrogate = lead == 0xED && second >= 0xA0;
  const bool too_large = lead == 0xF4 && second >= 0x90;
  return overlong || surrogate || too_large ? 0 : length;
}

std::string shown(std::string_view text, std::size_t most) {
  std::string out;
  std::size_t characters = 0, kept = 0;  // of out; kept: bytes of it that leave room for kCut
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const std::string_view c = text.substr(0, std::max<std::size_t>(length, 1));
    const bool escaped = length == 0 || has_power(c);
    characters += escaped ? 4 * c.size() : 1;
    if (characters > most) {
      out.resize(kept);
      return out.append(kCut);
    }
    if (escaped) append_escaped(out, c);
    else out.append(c);
    if (characters + kCut.size() <= most) kept = out.size();
    text.remove_prefix(c.size());
  }
  return out;
}

std::string shown_path(std::string_view path) {
  if (path.size() <= kMostOfPath) return shown(path, 4 * kMostOfPath);
  path.remove_prefix(path.size() - kMostOfPath);
  while ((byte_of(path, 0) & 0xC0) == 0x80 && path.size() > 1) path.remove_prefix(1);  // not inside a character
  return std::string(kCut) + shown(path, 4 * kMostOfPath);
}

}  // namespace tactus
