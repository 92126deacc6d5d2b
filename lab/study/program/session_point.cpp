// SPDX-License-Identifier: Apache-2.0
/// Points of `tactus bench session`: a motion over one network.
#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tactus/trace/trace_file.h>
#include "cli/command.h"
#include "cli/options/option_needs.h"
#include "cli/options/options_codec.h"
#include "cli/report/report.h"
#include "lab/study/program/points.h"
#include "lab/study/session.h"

namespace tactus::study {
namespace {

namespace library = sim::study;
using library::Motion;

constexpr std::size_t kMostBytes = std::size_t{1} << 30;  // of a trace: all of it is in memory

std::size_t size_of(const TraceFrame& frame) {
  std::size_t out = sizeof frame + frame.objects.size() * sizeof(RigidSample) + frame.users.size() * sizeof(UserSample);
  for (const DeformableSample& mesh : frame.meshes) out += sizeof mesh + mesh.displacements.size() * sizeof(float);
  return out;
}

/// Options of `tactus encode`, as typed there.
struct EncoderOptions {
  cli::TriggerArguments triggers;
  cli::MeshArguments meshes;
};

Motion read_motion(const std::string& path, const EncoderOptions& options) {
  auto reader = need(TraceReader::open(path), path);
  Motion out{.name = path.substr(path.rfind('/') + 1),
             .info = reader.info(),
             .frames = {},
             .sender = options.meshes.sender(options.triggers),
             .coding = options.meshes.coding(options.triggers)};
  if (out.info.objects.empty() && out.info.meshes.empty())
    refuse_request(path + ": no object moves", "Give a trace with rigid or deformable objects.");
  TraceFrame frame;
  std::size_t bytes = 0;
  while (need(reader.next(frame), path)) {
    TraceFrame kept = frame;
    for (DeformableSample& mesh : kept.meshes)
      if (!mesh.updated) mesh.displacements = {};
    kept.tick = static_cast<std::int64_t>(out.frames.size());  // a gap in a recording takes no time here
    bytes += size_of(kept);
    if (bytes > kMostBytes)
      refuse_request(path + ": more than 1 GiB from tick " + std::to_string(frame.tick) + " on", "Give a shorter trace.");
    out.frames.push_back(std::move(kept));
  }
  if (out.frames.empty()) refuse_request(path + ": no frame", "Give a trace with at least one tick.");
  return out;
}

/// A motion that is made here, of so many "ticks".
Motion made_motion(Request& request) {
  const auto name = request.get<std::string>("made", "swinging");
  const auto ticks = request.get<std::int64_t>("ticks");
  if (name == "swinging") return library::swinging_bodies(ticks);
  const auto seed = request.get<std::uint64_t>("motion_seed", 1);
  if (name == "boxes") return library::tumbling_boxes(ticks, seed);
  if (name == "knocks") return library::knocked_objects(ticks, seed);
  if (name == "billiard") return library::billiard(ticks, seed);
  if (name == "juggling") return library::juggled_clubs(ticks, seed);
  if (name == "sheet") return library::drawn_sheet(ticks, seed);
  refuse_request("\"made\": there is no motion \"" + name + "\"", "Give swinging, boxes, knocks, billiard, juggling or sheet.");
}

library::SessionCase with_policy(library::SessionCase one, Request& request) {
  const auto policy = request.get<std::string>("policy", "by role");
  if (policy != "by role" && policy != "repair" && policy != "prompt")
    refuse_request("\"policy\" \"" + policy + "\"", "Give by role, repair or prompt.");
  if (policy != "by role") one.policy = policy == "repair" ? LossPolicy::repair : LossPolicy::prompt;
  return one;
}

/// "trace" with the options of its "encoder", or a motion that is made.
Motion motion_of(Request& request) {
  if (!request.has("trace")) return made_motion(request);
  const auto path = request.get<std::string>("trace");
  const auto words = request.get<std::vector<std::string>>("encoder", {});
  EncoderOptions options;  // they look at the parser, which has to stay as long as they are used
  cli::Program parser("tactus bench session", "Options of the encoder");
  cli::add_encoder_options(parser, options.triggers, options.meshes);
  parser.on_chosen([&parser] { cli::check_options_agree(parser); });
  std::vector<std::string> line{"tactus"};
  line.insert(line.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& word : line) arguments.push_back(word.data());
  const auto parsed = parser.parse(static_cast<int>(arguments.size()), arguments.data());
  if (!parsed) throw Refused{parsed.error()};
  return read_motion(path, options);
}

bool fits(const library::SessionCase& one, double seconds) {
  const auto outage = std::ranges::max_element(one.link.outages, {}, &sim::Outage::end);
  return outage == one.link.outages.end() || 1e-6 * static_cast<double>(outage->end) + 1 < seconds;
}

Json json_of(const library::SessionResult& r) {
  const cli::TrafficLayers down = cli::sent_layers(r.down, r.seconds), up = cli::sent_layers(r.up, r.seconds);
  Json out{{"group", r.of.group},
           {"case", r.of.name},
           {"loss", r.of.link.loss},
           {"seconds", r.seconds},
           {"ticks", r.ticks},
           {"ticks_over",
            {{"any", r.over}, {"position", r.position}, {"rotation", r.rotation}, {"force", r.force}, {"shape", r.shape}}},
           {"longest_run_s", r.longest},
           {"mean_run_s", r.mean},
           {"shown_behind_s", r.behind},
           {"down_bit_per_s", {{"payload", down.payload}, {"session", down.session}, {"udp_ipv4", down.headers}}},
           {"up_bit_per_s", up.all()},
           {"bound_scale",
            {{"largest", r.bound_scaling.largest},
             {"mean", r.mean_bound_scale},
             {"for_s", 1e-6 * static_cast<double>(r.bound_scaling.time)}}},
           {"error_bounds", {{"median", r.error_median}, {"p95", r.error_p95}, {"worst", r.worst}}},
           {"wrong_states", r.down.wrong_states},
           {"coding_cpu_s", r.server_time}};
  if (r.recovery > 0) out["recovery_s"] = r.recovery;
  return out;
}

}  // namespace

Json session_point(Request& request) {
  const auto point = request.get<std::string>("point");
  const auto cases = library::session_cases(request.get("short", false), request.get<std::uint64_t>("seed", 1));
  if (point == "case") {
    const auto index = request.get<std::size_t>("index");
    const Motion motion = motion_of(request);
    if (index >= cases.size()) refuse_request("\"index\"", "The point \"motion\" lists the cases.");
    library::SessionCase one = with_policy(cases[index], request);
    if (request.has("round_trip_us")) one.link.delay = request.get<std::int64_t>("round_trip_us") / 2;
    request.check_all_known();
    return json_of(need(library::run_session(motion, one), motion.name));
  }
  if (point != "motion") refuse_request("there is no point \"" + point + "\"", "Give motion or case.");
  const Motion motion = motion_of(request);
  request.check_all_known();
  const double seconds = static_cast<double>(motion.frames.size()) / motion.info.tick_rate;
  Json out{{"name", motion.name},
           {"ticks", motion.frames.size()},
           {"tick_rate_hz", motion.info.tick_rate},
           {"seconds", seconds},
           {"chain_payload_bit_per_s", need(library::chain_payload(motion), motion.name)},
           {"cases", Json::array()}};
  for (std::size_t i = 0; i < cases.size(); ++i)
    if (fits(cases[i], seconds)) out["cases"].push_back({{"index", i}, {"group", cases[i].group}, {"case", cases[i].name}});
  return out;
}

}  // namespace tactus::study
