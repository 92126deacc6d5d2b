// SPDX-License-Identifier: Apache-2.0
#include "cli/figure/time_figure.h"

#include <algorithm>
#include <cmath>

namespace tactus::cli {
void TimeLine::add(double time, double value) {
  const Sample sample{time, value};
  if (in_last_ == per_piece_ || pieces_.empty()) {
    if (pieces_.size() == kMost) {
      for (std::size_t i = 0; i < kMost / 2; ++i) {
        const Piece &a = pieces_[2 * i], &b = pieces_[2 * i + 1];
        pieces_[i] = {a.low.value <= b.low.value ? a.low : b.low, a.high.value >= b.high.value ? a.high : b.high};
      }
      pieces_.resize(kMost / 2);
      per_piece_ *= 2;
    }
    pieces_.push_back({sample, sample});
    in_last_ = 0;
  }
  ++in_last_;
  Piece& last = pieces_.back();
  if (value < last.low.value) last.low = sample;
  if (value > last.high.value) last.high = sample;
}

std::vector<Point> TimeLine::points() const {
  std::vector<Point> out;
  for (const Piece& piece : pieces_) {
    const auto& [a, b] = piece.low.time <= piece.high.time ? std::pair(piece.low, piece.high) : std::pair(piece.high, piece.low);
    out.push_back({a.time, a.value});
    if (b.time > a.time) out.push_back({b.time, b.value});
  }
  return out;
}

std::vector<Point> RateLine::points(double width, double end) const {
  std::vector<double> sums(static_cast<std::size_t>(end / width) + 1);
  for (const auto& [time, amount] : events_) sums[std::min(static_cast<std::size_t>(time / width), sums.size() - 1)] += amount;
  std::vector<Point> out;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double from = width * static_cast<double>(i), to = std::min(from + width, end);
    if (to - from < 0.5 * width && i > 0) break;  // too short for a rate
    out.push_back({from, sums[i] / (to - from)});
    out.push_back({to, sums[i] / (to - from)});
  }
  return out;
}

double width_of_rates(double duration) {
  const double wanted = std::max(duration, 1e-3) / 60, power = std::pow(10, std::floor(std::log10(wanted)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= wanted * (1 - 1e-9)) return digit * power;
  return 10 * power;
}

}  // namespace tactus::cli
