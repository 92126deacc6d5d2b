// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace tactus::cli {

// ==== terminal ====

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

// ==== progress ====

namespace {

constexpr std::size_t kWidth = 30, kLeastWidth = 5;
constexpr std::size_t kBeside = 23;  // columns for figures and blanks beside label and bar
constexpr std::chrono::milliseconds kPeriod{100};

/// Cells of a bar that leaves room for the rest of its line: a line that wraps cannot be drawn over.
std::size_t width_beside(const std::string& label) {
  const std::size_t columns = columns_of(kStandardError), taken = label.size() + kBeside;
  return std::clamp(columns > taken ? columns - taken : 0, kLeastWidth, kWidth);
}

}  // namespace

Progress::Progress(std::string label, std::optional<std::uint64_t> total, Visibility visibility)
    : label_(std::move(label)),
      total_(total),
      visible_(visibility == Visibility::shown && is_capable_terminal(kStandardError)),
      coloured_(is_coloured(kStandardError)),
      start_(Clock::now()),
      next_(start_ + kPeriod) {}

Progress::~Progress() {
  if (drawn_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::update(std::uint64_t done) {
  if (!visible_) return;
  if (const auto now = Clock::now(); now >= next_) draw(done, now);
}

void Progress::draw(std::uint64_t done, Clock::time_point now) {
  next_ = now + kPeriod;
  drawn_ = true;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  if (!total_ || *total_ == 0) {
    fmt::print(stderr, "\r{} {} so far, {:.0f} s\x1b[K", label_, done, seconds);
  } else {
    const double fraction = std::min(1.0, static_cast<double>(done) / static_cast<double>(*total_));
    const std::size_t width = width_beside(label_);
    const auto filled = static_cast<std::size_t>(fraction * static_cast<double>(width));
    const double left = fraction > 0 ? seconds / fraction - seconds : 0;
    fmt::print(stderr, "\r{} {}{:━<{}}{}{:─<{}} {:3.0f} %  {:.0f} s left\x1b[K", label_, coloured_ ? "\x1b[36m" : "", "", filled,
               coloured_ ? "\x1b[0m" : "", "", width - filled, 100 * fraction, left);
  }
  std::fflush(stderr);
}

}  // namespace tactus::cli
