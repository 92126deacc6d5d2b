// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/text.h>

#include <algorithm>
#include <cstdint>

#include <tactus/base/shown.h>

namespace tactus {

bool is_utf8(std::string_view text) noexcept {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

bool is_plain_name(std::string_view text) noexcept {
  const auto forbidden = [](char c) { return c == '/' || c == 0x7F || static_cast<std::uint8_t>(c) < 0x20; };
  return !text.empty() && text.size() <= 255 && std::none_of(text.begin(), text.end(), forbidden) && is_utf8(text);
}

}  // namespace tactus
