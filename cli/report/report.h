// SPDX-License-Identifier: Apache-2.0
/// Reports of commands that compute: what was sent, how far a replica was from the truth, what it cost; as values of schema report.json, and the
/// parts that other reports have too.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tactus/metrics/deformable_errors.h>
#include <tactus/metrics/errors.h>
#include <tactus/metrics/rates.h>
#include <tactus/session/session_client.h>
#include <tactus/session/session_options.h>
#include <tactus/trace/read_notes.h>
#include "cli/options/options_codec.h"
#include "cli/report/printer.h"
#include "cli/report/table.h"

namespace tactus::cli {

// ==== step times ====

/// What a piece of work took. CPU time is that of all threads of the process: unlike wall-clock time it does not grow with what else
/// the machine has to do.
struct Cost {
  std::int64_t wall_ns = 0, cpu_ns = 0;
};

class Stopwatch {
 public:
  Stopwatch() noexcept;
  Cost elapsed() const noexcept;  ///< since construction, less what reading the CPU clock takes itself

 private:
  using Clock = std::chrono::steady_clock;
  std::int64_t cpu_;
  Clock::time_point wall_;
};

enum class TimeOf : std::uint8_t { wall, cpu };

/// Times of one step that is done again and again.
class StepTimes {
 public:
  /// Run `work` and remember how long it took.
  template <class Work>
  auto measure(Work&& work) {
    const Stopwatch watch;
    auto result = std::forward<Work>(work)();
    add(watch.elapsed());
    return result;
  }
  void add(Cost cost);
  bool empty() const noexcept { return wall_ns_.empty(); }
  std::size_t count() const noexcept { return wall_ns_.size(); }
  double quantile(TimeOf which, double fraction) const;  ///< [s]; 1: the longest.   pre  not empty
  double total(TimeOf which) const noexcept;             ///< [s]

 private:
  const std::vector<std::int64_t>& times(TimeOf which) const noexcept { return which == TimeOf::wall ? wall_ns_ : cpu_ns_; }

  std::vector<std::int64_t> wall_ns_, cpu_ns_;
};

// ==== mesh report ====
// What a report holds of one deformable object.

struct MeshReport {
  std::string name;
  std::size_t vertices = 0, triangles = 0;  ///< triangles 0: not said
  std::optional<DeformableRates> traffic{};
  std::optional<DeformableErrors> fidelity{};
  std::uint64_t frames = 0;  ///< written or read; 0: not said
  double frame_period = 0;   ///< [s] from one to the next, if frames
  bool guaranteed = true;    ///< the bounds are: false where they only decide what is sent
  StepTimes encode{}, decode{};
};

/// With `header` bytes below each packet.
inline double bytes_of(const DeformableRates& t, std::uint64_t header) {
  return static_cast<double>(t.bytes + t.sizes.size() * header);
}

// ==== traffic layers ====
// What an end of a session sends, layer by layer.

struct TrafficLayers {
  double packets, datagrams;               ///< [1/s]
  double payload, session, seal, headers;  ///< [bit/s]; headers of UDP and IPv4
  double all() const noexcept { return payload + session + seal + headers; }
};

/// in   overhead  of the seal around each datagram [bytes], 0: there is none
inline TrafficLayers sent_layers(const Traffic& traffic, double seconds, std::size_t overhead = 0) {
  const auto rate = [seconds](std::uint64_t amount) { return per(static_cast<double>(amount), seconds); };
  return {.packets = rate(traffic.packets_sent),
          .datagrams = rate(traffic.datagrams_sent),
          .payload = 8 * rate(traffic.payload_sent),
          .session = 8 * rate(traffic.bytes_sent - traffic.payload_sent),
          .seal = 8 * rate(overhead * traffic.datagrams_sent),
          .headers = 8 * rate(kUdpHeader * traffic.datagrams_sent)};
}

// ==== network report ====
// How a user's session over an emulated network went: what it cost, and how far what the client showed was from the truth of that tick.

/// One direction: what an end sent, and what the network did to it.
struct DirectionReport {
  Traffic traffic{};                                                ///< of the end that sends
  std::uint64_t sent = 0, lost = 0, duplicated = 0, reordered = 0;  ///< datagrams
};

struct NetworkReport {
  std::string user;
  ErrorMetrics errors;               ///< of what was shown against the truth of the tick shown
  std::vector<MeshReport> meshes{};  ///< the same, of deformable objects
  std::uint64_t not_shown = 0;       ///< ticks in which the client had nothing to show
  std::uint64_t without_force = 0;   ///< ticks in which old data kept the client from rendering its full force
  double delay_sum = 0;              ///< [s] of the ticks shown, behind the server's
  std::uint64_t shown = 0;
  StepTimes shapes{}, poses{},
      compensation{};  ///< what the client computed for its user, per tick; empty: there is nothing of it
  SessionStatus status{};
  BoundScaling bound_scaling{};  ///< of the bounds, by the server
  DirectionReport up{}, down{};
};

// ==== report ====
// The one table with which every computing command ends: what was sent, how far the replica was from the truth, what it cost.

struct Timing {
  std::string step;  ///< "encode"
  StepTimes times{};
};

/// What of a stream is no packet.
struct StreamSize {
  std::uint64_t header_bytes = 0;
  std::optional<std::uint64_t> file_bytes{};  ///< of the whole file, if there is one
};

/// How a user touched what is there.
struct TouchReport {
  std::string user;
  double contact_fraction = 0;         ///< of the ticks
  std::uint64_t contacts = 0;          ///< begun
  std::uint32_t most_in_a_second = 0;  ///< of them
  double largest_force = 0;            ///< [N] rendered
  double largest_server_force = 0;     ///< [N]
  double swing = 0;                    ///< [m] to and fro, while the hand was to hold still
  double lowest_energy = 0;            ///< [J] of a contact, at most 0
};

/// How a deformable object was simulated.
struct DeformableReport {
  std::string name, method, reason;
  std::size_t vertices = 0;
  double step = 0;                             ///< [s]
  double h_omega = 0;                          ///< step times the largest angular frequency; 0: not known
  std::uint64_t samples = 0;                   ///< steps whose error was looked at
  double error_of_motion = 0, error_most = 0;  ///< RMS of a step, and the largest; fractions of the RMS motion in a step
  double energy_gained = 0;                    ///< without cause, over the whole run; fraction of all the work of forces
};

/// What a rigid simulation knows of its own error.
struct RigidReport {
  struct Worst {
    double value = 0, at = 0;  ///< at [s]
    std::string object{};      ///< empty: there was none
  };
  struct Object {
    std::string name;
    double penetration = 0, drift = 0, flight = 0;  ///< [m], [m], [J]
  };
  Worst penetration{}, drift{}, flight{}, residual{};  ///< [m], [m], [J], [m/s]
  double contact_energy = 0, momentum = 0;             ///< [J], [N s]
  std::uint64_t steps = 0, again = 0, unsolved = 0;    ///< of groups of touching objects
  std::vector<Object> objects{};
};

struct EnergyDifference {
  double largest = 0, of = 0;  ///< [J] the largest difference, and the most that the energy changed since the first tick
  double square_sum = 0;       ///< of differences, as many as of the quantity
};

/// How far a simulation was from a finer one of the same scene.
struct CheckReport {
  struct Quantity {
    std::string name;                          ///< of an object, or a user
    double largest = 0, at = 0, of = 0;        ///< the largest difference, when [s], and the largest value itself
    double square_sum = 0;                     ///< of differences,
    std::uint64_t count = 0;                   ///< so many
    std::optional<EnergyDifference> energy{};  ///< of an object; of a user the work of the hand
  };
  std::string against;              ///< "half the step"
  std::vector<Quantity> objects{};  ///< [m] position, of the displacement from its first one
  std::vector<double> turns{};      ///< [rad] largest difference in rotation, one per object
  std::vector<Quantity> users{};    ///< [N] rendered force
  std::vector<Quantity> meshes{};   ///< [m] vertex farthest off, of the largest displacement
  double cpu = 0;                   ///< [s] of the finer run
};

/// How a client passes over to updates.
enum class ClientDisplay : std::uint8_t { direct, smoothed, interpolated };

constexpr ClientDisplay display_of_client(Interpolation interpolation, bool is_smoothed) {
  if (interpolation != Interpolation::none) return ClientDisplay::interpolated;
  return is_smoothed ? ClientDisplay::smoothed : ClientDisplay::direct;
}

struct Report {
  std::string command;
  std::vector<std::pair<std::string, std::string>> files{};  ///< role, path
  std::uint32_t tick_rate = 0;                               ///< 0: not known
  TickSpan ticks{};                                          ///< looked at
  std::uint64_t moving = 0;                                  ///< objects that can move
  std::size_t objects = 0, users = 0;
  std::optional<std::uint64_t> seed{}, segments{};
  std::optional<ClientDisplay> client{};
  std::vector<DeformableReport> deformables{};
  std::optional<RigidReport> rigid{};
  std::vector<CheckReport> checks{};
  std::vector<TouchReport> touches{};  ///< one per user
  std::vector<std::string> warnings{};
  std::vector<std::string> notes{};  ///< of readers, which were printed as they came
  std::string bounds_from{};         ///< "stream", "options", "defaults"; empty: no verdict on them
  std::optional<StreamSize> stream{};
  std::optional<RateMetrics> traffic{};
  std::optional<LoadRates> loads{};
  std::optional<ErrorMetrics> fidelity{};
  std::vector<MeshReport> meshes{};
  std::vector<NetworkReport> networks{};  ///< one per user with a session
  std::vector<Timing> timings{};

  /// Take over what a trace's description says.
  void describe(const TraceInfo& info);
  void add(const std::vector<ReadNote>& read);
  /// From the first tick to the last, with those that a recording leaves out: what rates are per.
  double seconds() const { return tick_rate == 0 ? 0 : static_cast<double>(ticks.length()) / tick_rate; }
  /// Payload of all parts of the stream, and how many packets it came in.
  std::pair<std::uint64_t, std::uint64_t> bytes_and_packets() const;
};

/// Make room for what is sent of a trace's meshes and how far it is off.
void add_meshes(const TraceInfo& info, const MeshArguments& meshes, const TriggerArguments& triggers, Report& report);

/// Which bounds are broken, where and how often: "position in 12 of 1000 ticks"; empty when all hold.
std::string broken_bounds(const Report& report);
/// Of users who feel forces without any contact; empty: there are none.   "No force bound: the recording has forces of user hand ..."
std::string missing_force_bound(const Report& report);
/// in  objects  how many rigid objects there are;  declare  the option that declares contacts
std::string missing_force_bound(std::vector<std::string> users, std::size_t objects, const std::string& declare = "--contact");
/// A failure that says so.   in  file  that was judged
Outcome verdict(const Report& report, const std::string& file);

enum class Destination { standard_output, standard_error };
/// Print as the options say: JSON, text, or nothing when quiet.
void print(const Report& report, const CommonOptions& options, Destination destination);
/// Where a report goes beside this output file.
inline Destination beside(const std::string& path) {
  return path == "-" ? Destination::standard_error : Destination::standard_output;
}

// ==== json parts ====
// Parts of values that several commands print: cli/schemas/parts.json.

struct Value;

/// in   seconds  of the recording, 0: there is none
Value time_value(const StepTimes& times, double seconds);
Value rigid_traffic_value(const Report& report);  ///< pre  it has traffic
Value load_traffic_value(const LoadRates& traffic, double seconds);
Value mesh_traffic_value(const MeshReport& mesh, double seconds);
Value stream_value(const Report& report);  ///< pre  it has a stream
Value bounds_value(const RigidTriggers& bounds);
/// in   guaranteed  false: the bounds only decide what is sent
Value mesh_bounds_value(const DeformableThresholds& bounds, std::uint8_t rings, bool guaranteed);
Value bound_scaling_value(const BoundScaling& scaling);

/// {"error": ...}, schema error.json
std::string error_json(const Failure& failure);

}  // namespace tactus::cli
