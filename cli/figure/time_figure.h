// SPDX-License-Identifier: Apache-2.0
/// Quantities over the time of a recording, as figures show them.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "cli/figure/figure.h"

namespace tactus::cli {

/// A quantity over time, of which a figure shows the extremes: it keeps at most kMost pieces, however long the recording.
class TimeLine {
 public:
  static constexpr std::size_t kMost = 1500;

  /// pre  `time` is not before the last
  void add(double time, double value);
  bool is_empty() const noexcept { return pieces_.empty(); }
  /// Time and value; of a piece with several samples its least and its largest one, in the order in which they came.
  std::vector<Point> points() const;

 private:
  struct Sample {
    double time, value;
  };
  struct Piece {
    Sample low, high;
  };

  std::vector<Piece> pieces_;
  std::uint64_t per_piece_ = 1, in_last_ = 0;  // samples
};

/// Packets over time, as a rate.
class RateLine {
 public:
  void add(double time, double amount = 1) { events_.emplace_back(time, amount); }
  bool is_empty() const noexcept { return events_.empty(); }
  /// Steps of amount per second, in `width` s each.   pre  width > 0
  std::vector<Point> points(double width, double end) const;

 private:
  std::vector<std::pair<double, double>> events_;
};

/// [s] 1, 2 or 5 times a power of ten, so that some 60 of them fill the duration.
double width_of_rates(double duration);

}  // namespace tactus::cli
