// SPDX-License-Identifier: Apache-2.0
#include "conformance/session_script.h"

#include <cstdlib>

namespace tactus::conformance {

std::string hex(std::span<const std::uint8_t> bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes) {
    out += "0123456789abcdef"[byte >> 4];
    out += "0123456789abcdef"[byte & 15];
  }
  return out;
}

std::string hex(std::uint64_t value, unsigned digits) {
  std::string text(digits, '0');
  for (unsigned i = digits; i-- > 0; value >>= 4) text[i] = "0123456789abcdef"[value & 15];
  return text;
}

std::optional<std::string_view> member(std::string_view line, const std::string& name) {
  const std::size_t at = line.find('"' + name + "\":");
  if (at == std::string_view::npos) return std::nullopt;
  std::string_view value = line.substr(at + name.size() + 3);
  const bool quoted = !value.empty() && value[0] == '"';
  if (quoted) value.remove_prefix(1);
  return value.substr(0, value.find_first_of(quoted ? "\"" : ",}"));
}

std::uint64_t number(std::string_view line, const std::string& name, int base) {
  return std::strtoull(std::string(member(line, name).value_or("0")).c_str(), nullptr, base);
}

std::optional<Bytes> bytes_of(std::string_view text) {
  Bytes out;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    char* end = nullptr;
    const std::string pair(text.substr(i, 2));
    out.push_back(static_cast<std::uint8_t>(std::strtoul(pair.c_str(), &end, 16)));
    if (*end != 0) return std::nullopt;
  }
  return text.size() % 2 == 0 ? std::optional(out) : std::nullopt;
}

}  // namespace tactus::conformance
