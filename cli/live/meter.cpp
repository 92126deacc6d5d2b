// SPDX-License-Identifier: Apache-2.0
#include "cli/live/meter.h"

#include <fmt/format.h>

#include "cli/terminal.h"

namespace tactus::cli {

Meter::Meter(Visibility visibility) : visible_(visibility == Visibility::shown && is_capable_terminal(kStandardError)) {}

Meter::~Meter() {
  if (drawn_) fmt::print(stderr, "\r\x1b[K");
}

void Meter::draw(std::uint64_t now, const std::string& text) {
  constexpr std::uint64_t kEvery = 200'000;
  next_ = now + kEvery;
  drawn_ = true;
  fmt::print(stderr, "\r{}\x1b[K", text);
  std::fflush(stderr);
}

}  // namespace tactus::cli
