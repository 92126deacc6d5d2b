// SPDX-License-Identifier: Apache-2.0
#include "cli/live/keyboard.h"

#include <poll.h>
#include <unistd.h>

namespace tactus::cli {

Keyboard::Keyboard() noexcept {
  termios settings{};
  if (isatty(STDIN_FILENO) == 0 || tcgetpgrp(STDIN_FILENO) != getpgrp() || tcgetattr(STDIN_FILENO, &settings) != 0) return;
  before_ = settings;
  settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // Ctrl-C still interrupts
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  tcsetattr(STDIN_FILENO, TCSANOW, &settings);
}

Keyboard::~Keyboard() {
  if (before_) tcsetattr(STDIN_FILENO, TCSANOW, &*before_);
}

std::optional<char> Keyboard::pressed() noexcept {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char key = 0;
  if (!before_ || poll(&input, 1, 0) <= 0 || read(STDIN_FILENO, &key, 1) != 1) return std::nullopt;
  return key;
}

}  // namespace tactus::cli
