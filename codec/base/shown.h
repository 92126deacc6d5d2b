// SPDX-License-Identifier: Apache-2.0
/// Escapes untrusted text for a terminal, a message or a figure.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tactus {

/// Bytes of the UTF-8 sequence (RFC 3629) at the front of `text`, 0 when there is none: shortest forms only, no surrogates, nothing
/// above U+10FFFF.   pre  `text` is not empty
std::size_t utf8_length(std::string_view text) noexcept;

/// `text` escaped for a terminal: control characters (C0, DEL, C1), line separators, bidirectional controls and bytes that are
/// not UTF-8 become \xNN. At most `most` characters, including the "..." that marks an omission.
std::string shown(std::string_view text, std::size_t most = 60);

/// The same for a path, kept long enough to copy: up to 240 characters. A longer path keeps its end.
std::string shown_path(std::string_view path);

}  // namespace tactus
