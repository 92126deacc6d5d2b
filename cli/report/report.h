// SPDX-License-Identifier: Apache-2.0
/// The one table with which every computing command ends: what was sent, how far the replica was from the truth, what it cost.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tactus/metrics/errors.h>
#include <tactus/metrics/rates.h>
#include "cli/options/options_codec.h"
#include "cli/report/mesh_report.h"
#include "cli/report/network_report.h"
#include "cli/report/touch_report.h"

namespace tactus::cli {

struct Timing {
  std::string key;    ///< in JSON: "encode"
  std::string label;  ///< in the table: "encode, per tick"
  StepTimes times{};
};

/// What of a stream is no packet.
struct StreamSize {
  std::uint64_t header_bytes = 0;
  std::optional<std::uint64_t> file_bytes{};  ///< of the whole file, if there is one
};

/// How a deformable object was simulated.
struct DeformableReport {
  std::string name, method, reason;
  std::size_t vertices = 0;
  double step = 0;                      ///< [s]
  double h_omega = 0;                   ///< step times the largest angular frequency; 0: not known
  std::uint64_t samples = 0;            ///< steps whose error was looked at
  double error_p50 = 0, error_max = 0;  ///< relative
  double energy_gained = 0;             ///< without cause, over the whole run; share of all the work of forces
};

/// How a client passes over to updates.
enum class ClientWay : std::uint8_t { direct, eased, interpolated };

constexpr ClientWay way_of_client(Interpolation interpolation, bool is_eased) {
  if (interpolation != Interpolation::none) return ClientWay::interpolated;
  return is_eased ? ClientWay::eased : ClientWay::direct;
}

struct Report {
  std::string command;
  std::vector<std::pair<std::string, std::string>> files{};  ///< role, path
  std::uint32_t tick_rate = 0;                               ///< 0: not known
  TickSpan ticks{};                                          ///< looked at
  std::uint64_t moving = 0;                                  ///< objects that can move
  std::size_t objects = 0, users = 0;
  std::optional<std::uint64_t> seed{}, segments{};
  std::optional<ClientWay> client{};
  std::vector<DeformableReport> deformables{};
  std::vector<TouchReport> touches{};  ///< one per user
  std::vector<std::string> warnings{};
  std::string bounds_from{};  ///< "stream", "options", "defaults"; empty: no verdict on them
  std::optional<StreamSize> stream{};
  std::optional<RateMetrics> traffic{};
  std::optional<LoadRates> loads{};
  std::optional<ErrorMetrics> fidelity{};
  std::vector<MeshReport> meshes{};
  std::vector<NetworkReport> networks{};  ///< one per user with a session
  std::vector<Timing> timings{};

  /// Take over what a trace's description says.
  void describe(const TraceInfo& info);
  /// From the first tick to the last, with those that a recording leaves out: what rates are per.
  double seconds() const { return tick_rate == 0 ? 0 : static_cast<double>(ticks.length()) / tick_rate; }
  /// Payload of all parts of the stream, and how many packets it came in.
  std::pair<std::uint64_t, std::uint64_t> bytes_and_packets() const;
};

/// Make place for what is sent of a trace's meshes and how far it is off.
void add_meshes(const TraceInfo& info, const MeshArguments& meshes, const TriggerArguments& triggers, Report& report);

/// Rates of rigid objects' packets; `header` bytes go below each.   pre  there is traffic
struct RigidRates {
  double bits_per_s, bytes_per_packet, bytes_per_update, saved_24, saved_48;
};
RigidRates rigid_rates(const Report& report, std::uint64_t header);

/// Which bounds are broken, where and how often: "position in 12 of 1000 ticks"; empty when all hold.
std::string broken_bounds(const Report& report);
/// Of users who feel forces without any contact; empty: there are none.   "No force bound: the recording has forces of user hand ..."
std::string missing_force_bound(const Report& report);
/// A failure that says so.   in  file  that was judged
Outcome verdict(const Report& report, const std::string& file);

bool has_errors(const ErrorMetrics& fidelity);
/// Schema report.json: numbers in SI units.
std::string to_json(const Report& report);

enum class Destination { standard_output, standard_error };
/// Print as the options say: JSON, text, or nothing when quiet.
void print(const Report& report, const CommonOptions& options, Destination destination);
/// Where a report goes beside this output file.
inline Destination beside(const std::string& path) {
  return path == "-" ? Destination::standard_error : Destination::standard_output;
}

}  // namespace tactus::cli
