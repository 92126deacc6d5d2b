// SPDX-License-Identifier: Apache-2.0
/// Lines of the scripts of sessions, and the numbers in the answers to them (conformance/README.md).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::conformance {

using Bytes = std::vector<std::uint8_t>;

std::string hex(std::span<const std::uint8_t> bytes);
std::string hex(std::uint64_t value, unsigned digits);

/// The text of a member of a line that has no nested ones; nothing: it is not there.
std::optional<std::string_view> member(std::string_view line, const std::string& name);
/// The same as a number; 0 if it is not there.   in  base  10 or 16
std::uint64_t number(std::string_view line, const std::string& name, int base = 10);
/// Of hexadecimal digits; nothing: there are other characters, or half a byte.
std::optional<Bytes> bytes_of(std::string_view text);

}  // namespace tactus::conformance
