// SPDX-License-Identifier: Apache-2.0
/// A byte of length, then any bytes as text of others: what is shown of it has no power over a terminal, is short, and shows again as
/// itself.
#include <cstdint>
#include <string>
#include <string_view>

#include <tactus/base/shown.h>
#include "tests/fuzz/require.h"

namespace {

constexpr std::size_t kMostOfPath = 3 + 4 * 240;  // "...", then every byte as \xNN

/// UTF-8 without control characters (C1 too), separators of lines, and signs that turn the direction of writing.
void check(std::string_view text, std::size_t most) {
  std::size_t characters = 0;
  for (; !text.empty(); ++characters) {
    const std::size_t length = tactus::utf8_length(text);
    require(length > 0);
    const std::string_view one = text.substr(0, length);
    text.remove_prefix(length);
    require(one.size() > 1 || (one[0] >= 0x20 && one[0] != 0x7f));
    require(one < "\xc2\x80" || one >= "\xc2\xa0");
    require(one < "\xe2\x80\xa8" || one > "\xe2\x80\xae");
    require(one < "\xe2\x81\xa6" || one > "\xe2\x81\xa9");
    require(one != "\xd8\x9c" && one != "\xe2\x80\x8e" && one != "\xe2\x80\x8f");
  }
  require(characters <= most);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  const std::size_t most = std::size_t{3} + data[0];
  const std::string once = tactus::shown(text, most);
  check(once, most);
  require(tactus::shown(once, most) == once);
  check(tactus::shown_path(text), kMostOfPath);
  return 0;
}
