// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <termios.h>

#include <optional>

namespace tactus::cli {

/// Keys as they are pressed, without Enter, where standard input is a terminal; nothing elsewhere, or in the background.
class Keyboard {
 public:
  Keyboard() noexcept;
  ~Keyboard();  ///< the terminal is as it was before
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  bool is_there() const noexcept { return before_.has_value(); }
  std::optional<char> pressed() noexcept;  ///< the next key that waits; never blocks

 private:
  std::optional<termios> before_;
};

}  // namespace tactus::cli
