// SPDX-License-Identifier: Apache-2.0
/// The one table with which every computing command ends: what was sent, how far the replica was from the truth, what it cost.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/options_codec.h"
#include "codec/trace/compare.h"

namespace tactus::cli {

/// Wall-clock times of one step that is done again and again.
class StepTimes {
 public:
  using Clock = std::chrono::steady_clock;
  /// Run `work` and remember how long it took.
  template <class Work>
  auto measure(Work&& work) {
    const auto start = Clock::now();
    auto result = std::forward<Work>(work)();
    nanoseconds_.push_back(static_cast<std::uint32_t>(std::min<Clock::rep>((Clock::now() - start).count(), UINT32_MAX)));
    return result;
  }
  void add(double seconds) { nanoseconds_.push_back(static_cast<std::uint32_t>(std::min(1e9 * seconds, double{UINT32_MAX}))); }
  bool empty() const noexcept { return nanoseconds_.empty(); }
  std::size_t count() const noexcept { return nanoseconds_.size(); }
  double quantile(double share) const;  ///< [s]; 1: the longest
  double total() const noexcept;        ///< [s]

 private:
  std::vector<std::uint32_t> nanoseconds_;
};

struct Report {
  struct Timing {
    std::string step;  ///< "encode, per tick"
    StepTimes times;
  };
  std::string command;
  std::vector<std::pair<std::string, std::string>> files{};  ///< role, path
  std::uint32_t tick_rate = 0;                               ///< 0: not known
  std::uint64_t ticks = 0;                                   ///< looked at
  std::uint64_t moving = 0;                                  ///< objects that can move
  std::size_t objects = 0, users = 0;
  std::vector<std::pair<std::string, std::string>> notes{};  ///< what else a reader must know
  std::optional<Traffic> traffic{};
  std::optional<Fidelity> fidelity{};
  std::vector<Timing> timings{};

  /// Take over what a trace's description says.
  void describe(const TraceInfo& info);
  double seconds() const { return tick_rate == 0 ? 0 : static_cast<double>(ticks) / tick_rate; }
};

enum class Destination { standard_output, standard_error };
/// Print as the options say: JSON ("tactus.report/1"), text, or nothing when quiet.
void print(const Report& report, const CommonOptions& options, Destination destination);
/// Where a report goes beside this output file.
inline Destination beside(const std::string& path) {
  return path == "-" ? Destination::standard_error : Destination::standard_output;
}

}  // namespace tactus::cli
