// SPDX-License-Identifier: Apache-2.0
/// Text of untrusted files, from any system: the one place that knows encodings, ends of lines and how numbers are spelt, without a locale.
/// Internal to the libraries.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace tactus {

/// Shortest forms only, no surrogates, nothing above U+10FFFF.
bool is_utf8(std::string_view text) noexcept;

/// Fit for a name that becomes part of a topic and of a column: 1..255 bytes of UTF-8 without '/' and control characters.
bool is_plain_name(std::string_view text) noexcept;

/// Turns the bytes of a text file into UTF-8 whose lines end with \n, piece by piece: a byte order mark goes, UTF-16 of either order is
/// converted (with a mark, or without one where every other of the first bytes is 0), and \r\n and \r become \n. Halves of a surrogate pair
/// that stand alone become U+FFFD.
class TextDecoder {
 public:
  /// Append what is complete in `bytes` to `text`.   time O(bytes)
  void add(std::string_view bytes, std::string& text);
  /// The input has ended: append what was kept back.   out  what ended is no whole character (of UTF-16): false
  bool end(std::string& text);

 private:
  enum class Encoding : std::uint8_t { unknown, bytes, little, big };
  void settle();
  void take(std::string_view bytes, std::string& text);
  void take_unit(std::uint32_t unit, std::string& text);
  void put(char32_t character, std::string& text);

  Encoding encoding_ = Encoding::unknown;
  std::string kept_;           // bytes ahead of the decision, or half a unit
  std::uint32_t high_ = 0;     // half of a surrogate pair
  bool after_return_ = false;  // a \n that follows belongs to the \r before it
};

/// The same of a whole file.
std::string decode_text(std::string_view bytes);

/// The number that all of `text` spells; nothing when characters are left over or the type cannot hold it. A plus may stand in front, and
/// the exponent of a real number may be called D or d, as Fortran does.
template <class T>
std::optional<T> parse_number(std::string_view text) noexcept {
  if (text.starts_with('+') && !text.starts_with("+-") && !text.starts_with("++")) text.remove_prefix(1);
  char copy[64];
  if constexpr (std::is_floating_point_v<T>) {
    const std::size_t exponent = text.find_first_of("dD");
    if (exponent != std::string_view::npos && exponent > 0 && text.size() <= sizeof copy) {
      text.copy(copy, text.size());
      copy[exponent] = 'e';
      text = {copy, text.size()};
    }
  }
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace tactus
