// SPDX-License-Identifier: Apache-2.0
/// Text of others on its way to a terminal, a message or a figure.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tactus {

/// Bytes of the UTF-8 sequence (RFC 3629) at the front of `text`, 0 when there is none: shortest forms only, no surrogates, nothing
/// above U+10FFFF.   pre  `text` is not empty
std::size_t utf8_length(std::string_view text) noexcept;

/// `text` without power over a terminal: control characters (C0, DEL, C1), line separators, those that turn the direction of writing,
/// and bytes that are not UTF-8 stand as \xNN. At most `most` characters, of which "..." says that something was left out.
std::string shown(std::string_view text, std::size_t most = 60);

/// The same for a path, which a reader may want to copy: up to 240 characters, and of a longer one the end.
std::string shown_path(std::string_view path);

}  // namespace tactus
