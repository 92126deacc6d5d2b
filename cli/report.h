// SPDX-License-Identifier: Apache-2.0
/// The one table with which every computing command ends: what was sent, how far the replica was from the truth, what it cost.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/mesh_report.h"
#include "cli/options_codec.h"
#include "codec/trace/compare.h"

namespace tactus::cli {

struct Report {
  struct Timing {
    std::string step;  ///< "encode, per tick"
    StepTimes times;
  };
  std::string command;
  std::vector<std::pair<std::string, std::string>> files{};  ///< role, path
  std::uint32_t tick_rate = 0;                               ///< 0: not known
  TickSpan ticks{};                                          ///< looked at
  std::uint64_t moving = 0;                                  ///< objects that can move
  std::size_t objects = 0, users = 0;
  std::vector<std::pair<std::string, std::string>> notes{};  ///< what else a reader must know
  std::optional<Traffic> traffic{};
  std::optional<Fidelity> fidelity{};
  std::vector<MeshReport> meshes{};
  std::vector<Timing> timings{};

  /// Take over what a trace's description says.
  void describe(const TraceInfo& info);
  /// From the first tick to the last, with those that a recording leaves out: what rates are per.
  double seconds() const { return tick_rate == 0 ? 0 : static_cast<double>(ticks.length()) / tick_rate; }
};

/// Make place for what is sent of a trace's meshes and how far it is off.
void add_meshes(const TraceInfo& info, const MeshArguments& meshes, const TriggerArguments& triggers, Report& report);

enum class Destination { standard_output, standard_error };
/// Print as the options say: JSON ("tactus.report/1"), text, or nothing when quiet.
void print(const Report& report, const CommonOptions& options, Destination destination);
/// Where a report goes beside this output file.
inline Destination beside(const std::string& path) {
  return path == "-" ? Destination::standard_error : Destination::standard_output;
}

}  // namespace tactus::cli
