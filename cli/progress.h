// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace tactus::cli {

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
