// SPDX-License-Identifier: Apache-2.0
#include "cli/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace tactus::cli {

bool is_terminal(int stream) { return isatty(stream) != 0; }

bool is_capable_terminal(int stream) {
  const char* term = std::getenv("TERM");
  return is_terminal(stream) && term != nullptr && std::string_view(term) != "dumb";
}

bool is_coloured(int stream) {
  const char* refused = std::getenv("NO_COLOR");
  return is_capable_terminal(stream) && (refused == nullptr || *refused == '\0');
}

std::size_t columns_of(int stream) {
  winsize size{};
  return ioctl(stream, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace tactus::cli
