// SPDX-License-Identifier: Apache-2.0
/// What a terminal shows while work goes on.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace tactus::cli {

// ==== terminal ====
// What the program asks its terminal.

/// Standard streams, as every system numbers them.
inline constexpr int kStandardOutput = 1, kStandardError = 2;

bool is_terminal(int stream);
/// A terminal on which lines can be drawn again.
bool is_capable_terminal(int stream);
/// May text on this stream be emphasised: a terminal, and NO_COLOR is not set.
bool is_coloured(int stream);
/// Characters of a line; 80 where the terminal does not report it.
std::size_t columns_of(int stream);

// ==== progress ====

enum class Visibility { shown, hidden };

/// A bar on standard error while a command works; drawn only on a terminal, at most ten times per second, gone afterwards.
class Progress {
 public:
  /// in  total  steps of the whole work, if known
  Progress(std::string label, std::optional<std::uint64_t> total, Visibility visibility);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` steps are finished.   time about 30 ns between two drawings
  void update(std::uint64_t done);

 private:
  using Clock = std::chrono::steady_clock;
  void draw(std::uint64_t done, Clock::time_point now);

  std::string label_;
  std::optional<std::uint64_t> total_;
  bool visible_, coloured_, drawn_ = false;
  Clock::time_point start_, next_;
};

}  // namespace tactus::cli
