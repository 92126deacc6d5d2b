// SPDX-License-Identifier: Apache-2.0
/// What the program asks its terminal.
#pragma once

#include <cstddef>

namespace tactus::cli {

/// Standard streams, as every system numbers them.
inline constexpr int kStandardOutput = 1, kStandardError = 2;

bool is_terminal(int stream);
/// A terminal on which lines can be drawn again.
bool is_capable_terminal(int stream);
/// May text on this stream be emphasised: a terminal, and NO_COLOR is not set.
bool is_coloured(int stream);
/// Characters of a line; 80 where the terminal does not tell.
std::size_t columns_of(int stream);

}  // namespace tactus::cli
