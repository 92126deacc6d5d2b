// SPDX-License-Identifier: Apache-2.0
/// Points of `tactus bench stability`, `delay` and `signals`.
#include <array>
#include <utility>
#include <vector>

#include <tactus/trace/trace_file.h>
#include "lab/study/delay_sweep.h"
#include "lab/study/program/points.h"
#include "lab/study/signals.h"
#include "lab/study/stability.h"
#ifdef TACTUS_HAS_FEM
#include "lab/study/stability_fem.h"
#endif

namespace tactus::study {
namespace {

namespace library = sim::study;

using StabilityCase = library::Study (*)(library::Extent, const library::Progress&);
constexpr std::pair<const char*, StabilityCase> kCases[]{{"jury", library::study_jury},
                                                         {"wall", library::study_wall},
                                                         {"client", library::study_client},
                                                         {"rigid", library::study_rigid},
#ifdef TACTUS_HAS_FEM
                                                         {"fem", library::study_fem}
#endif
};

Json json_of(const library::Study& study) {
  const auto optional = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  Json out{{"study", study.name}, {"title", study.title}, {"text", study.text}, {"rows", Json::array()}};
  for (const library::Row& row : study.rows) {
    Json parameters = Json::array();
    for (const library::Parameter& p : row.parameters)
      parameters.push_back({{"name", p.name}, {"value", p.value}, {"unit", p.unit}});
    out["rows"].push_back({{"subject", row.subject},
                           {"parameters", std::move(parameters)},
                           {"verdict", library::name(row.verdict)},
                           {"quantity", row.quantity},
                           {"unit", row.unit},
                           {"measured", optional(row.measured)},
                           {"analytic", optional(row.analytic)},
                           {"deviation", optional(row.deviation())},
                           {"remark", row.remark},
                           {"detail", row.detail}});
  }
  out["matrix"] = {{"corner", study.matrix.corner}, {"columns", study.matrix.columns}, {"rows", Json::array()}};
  for (const auto& [label, cells] : study.matrix.rows) out["matrix"]["rows"].push_back({{"label", label}, {"cells", cells}});
  out["series"] = Json::object();
  for (const library::Series& series : study.series)
    out["series"][series.name] = {{"columns", series.columns}, {"rows", series.rows}};
  return out;
}

Json json_of(const library::DelayNumbers& n) {
  return {{"mean_force_over", n.mean},     {"peak_force_over", n.peak},    {"outside_10_percent", n.outside},
          {"least_energy_J", n.energy},    {"force_error", n.force_error}, {"seen_away_rms_m", n.seen},
          {"seen_away_95_m", n.most_seen}, {"users_apart_95_m", n.apart}};
}

const char* name_of(library::Signal signal) {
  constexpr const char* kNames[]{"device", "contact", "force"};
  return kNames[static_cast<std::size_t>(signal)];
}

}  // namespace

Json stability_point(Request& request) {
  const auto name = request.get<std::string>("case");
  const auto extent = request.get("short", false) ? library::Extent::brief : library::Extent::full;
  request.check_all_known();
  for (const auto& [known, run] : kCases)
    if (name == known) return json_of(run(extent, [](const std::string&, std::uint64_t, std::uint64_t) {}));
  refuse_request("there is no case \"" + name + "\"", "Give jury, wall, client, rigid or, in a build with finite elements, fem.");
}

Json delay_point(Request& request) {
  const sim::Scene scene = scene_of(request);
  const library::DelayPoint point{.round_trip = request.get<std::int64_t>("round_trip_us"),
                                  .varies = request.get("varies", false),
                                  .seed = request.get<std::uint64_t>("seed", 1)};
  request.check_all_known();
  if (scene.users.empty() || scene.users.size() > library::kMostSweepUsers)
    refuse_request(scene.name + ": " + std::to_string(scene.users.size()) + " users", "Give a scene of one or two users.");
  const library::DelayResult result = need(library::run_point(scene, point));
  Json out{{"scene", scene.name}, {"users", Json::array()}};
  for (std::size_t user = 0; user < scene.users.size(); ++user) {
    Json clients = Json::array();
    for (std::size_t c = 0; c < library::kClients.size(); ++c) {
      Json numbers = json_of(result[c][user]);
      numbers["clients"] = library::name(library::kClients[c]);
      clients.push_back(std::move(numbers));
    }
    out["users"].push_back({{"user", scene.users[user].name}, {"clients", std::move(clients)}});
  }
  return out;
}

Json signals_point(Request& request) {
  const auto path = request.get<std::string>("trace");
  request.check_all_known();
  auto reader = need(TraceReader::open(path), path);
  const TraceInfo& info = reader.info();
  auto signals = need(library::SignalStudy::create(info), path);
  TickSpan ticks;
  TraceFrame frame;
  while (need(reader.next(frame), path)) {
    need(signals.add(frame), path, cli::location_of_tick(frame.tick));
    ticks.add(frame.tick);
  }
  const auto results = signals.results();
  if (results.empty())
    refuse_request(path + ": no device moves and no force acts",
                   "Give a trace with a user: `tactus import csv --map device=x,y,z` or `--map force=x,y,z` makes one.");
  Json out{{"tick_rate_hz", info.tick_rate},
           {"samples", ticks.count()},
           {"seconds", static_cast<double>(ticks.length()) / info.tick_rate},
           {"round_trip_s", library::SignalStudy::kRoundTrip},
           {"signals", Json::array()}};
  for (const library::SignalResult& r : results)
    out["signals"].push_back({{"user", info.users[r.user].name},
                              {"signal", name_of(r.signal)},
                              {"within", r.name},
                              {"samples", r.samples},
                              {"packets", r.packets},
                              {"bytes", r.bytes},
                              {"largest_error", r.largest},
                              {"rms_error", r.rms},
                              {"fraction_of_permitted", r.worst},
                              {"samples_over", r.over},
                              {"time_per_sample_s", r.time}});
  return out;
}

}  // namespace tactus::study
