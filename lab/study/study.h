// SPDX-License-Identifier: Apache-2.0
/// What a study of stability yields, for tables and plots.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tactus::sim::study {

/// stable    what was disturbed comes to rest, or stays within what the disturbance explains
/// limit     neither: it goes on within bounds
/// diverges  it grows without bound, or the simulation stopped with an error
enum class Verdict : std::uint8_t { stable, limit, diverges };
const char* name(Verdict verdict) noexcept;

/// A setting with its unit: {"k_o", 100, "N/m"}.
struct Parameter {
  std::string name;
  double value = 0;
  std::string unit;
};

struct Row {
  std::string subject{};  ///< "number of users"
  std::vector<Parameter> parameters{};
  Verdict verdict = Verdict::stable;
  std::string quantity{};            ///< what was measured, "sum of k_s"
  std::string unit{};                ///< of both figures below
  std::optional<double> measured{};  ///< none: there is only a verdict
  std::optional<double> analytic{};  ///< limit that theory gives
  std::string remark{};
  bool detail = false;  ///< for files only: a table sums it up

  /// measured / analytic - 1
  std::optional<double> deviation() const {
    if (!measured || !analytic || *analytic == 0) return std::nullopt;
    return *measured / *analytic - 1;
  }
};

/// Figures behind a plot.
struct Series {
  std::string name;                  ///< "step-stable"
  std::vector<std::string> columns;  ///< "t [s]"
  std::vector<std::vector<double>> rows{};
};

/// Words in rows and columns.
struct Matrix {
  std::string corner;
  std::vector<std::string> columns;
  std::vector<std::pair<std::string, std::vector<std::string>>> rows;
};

struct Study {
  std::string name;    ///< "jury"
  std::string title;   ///< of the figure and its section
  std::string text{};  ///< how it was measured, in whole sentences
  std::vector<Row> rows{};
  Matrix matrix{};  ///< may be empty
  std::vector<Series> series{};
};

/// A few seconds, for continuous integration, or as long as it takes.
enum class Extent : std::uint8_t { brief, full };

/// Called now and then with the progress of a piece of work.
using Progress = std::function<void(const std::string& work, std::uint64_t done, std::uint64_t total)>;

/// The border between `low`, which holds, and `high`, which does not, to a relative width.
/// pre  0 < low < high, holds(low) and not holds(high)
template <class Holds>
double bisect(double low, double high, double width, Holds&& holds) {
  while (high > low * (1 + width)) {
    const double middle = std::sqrt(low * high);
    (holds(middle) ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

}  // namespace tactus::sim::study
