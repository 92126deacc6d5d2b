// SPDX-License-Identifier: Apache-2.0
/// Parts of requests that several studies take.
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "lab/study/program/points.h"

namespace tactus::study {

sim::Scene scene_of(Request& request) {
  sim::Scene out = need(sim::load_scene(need(sim::find_scene(request.get<std::string>("scene")))));
  out.duration = std::min(out.duration, request.get("duration_s", out.duration));
  return out;
}

sim::LinkOptions link_of(Request& request, const std::string& key) {
  Request part = request.part(key);
  sim::LinkOptions out{.delay = part.get<std::int64_t>("delay_us", 0)};
  out.gamma_mean = part.get("gamma_mean_us", out.gamma_mean);
  out.gamma_deviation = part.get("gamma_deviation_us", out.gamma_deviation);
  out.gamma_piece = part.get("gamma_piece_us", out.gamma_piece);
  for (const auto& [time, delay] : part.get<std::vector<std::array<std::int64_t, 2>>>("recorded_us", {}))
    out.recorded.push_back({time, delay});
  part.check_all_known();
  return out;
}

sim::Grip grip_of_request(Request& request) {
  const auto name = request.get<std::string>("grip", "normal");
  if (name == "loose") return sim::Grip::loose;
  if (name == "normal") return sim::Grip::normal;
  if (name == "firm") return sim::Grip::firm;
  refuse_request("there is no grip \"" + name + "\"", "Give loose, normal or firm.");
}

}  // namespace tactus::study
