// SPDX-License-Identifier: Apache-2.0
/// Points of `tactus bench scale`, what a server of many clients and objects costs, and of `tactus bench join`, how long a join takes.
#include "lab/study/join.h"
#include "lab/study/program/points.h"
#include "lab/study/scale.h"

namespace tactus::study {

Json scale_point(Request& request) {
  sim::study::ScaleCase of;
  of.clients = request.get<std::uint16_t>("clients");
  of.objects = request.get<std::uint32_t>("objects");
  of.moving = request.get<std::uint32_t>("moving");
  of.ticks = request.get<std::int64_t>("ticks", 1000);
  of.seed = request.get<std::uint64_t>("seed", 1);
  of.loss = request.get<double>("loss", 0);
  of.role = request.get("participants", false) ? Role::participant : Role::observer;
  of.names_moved = request.get("names_moved", false);
  of.spread = request.get("spread", false);
  of.reach = request.get<double>("reach", 0);
  request.check_all_known();
  if (of.clients == 0 || of.moving > of.objects || of.objects == 0 || of.ticks < 1 || of.ticks > 1'000'000 || !(of.reach >= 0))
    refuse_request("a number of clients, objects or ticks is out of range",
                   "Give 1 to 65535 clients, and at most as many moving as objects.");
  const sim::study::ScaleResult result = need(sim::study::run_scale(of), "scale");
  return {{"clients", of.clients},
          {"objects", of.objects},
          {"moving", of.moving},
          {"loss", of.loss},
          {"ticks", of.ticks},
          {"live", result.live},
          {"tick_s", {{"mean", result.mean}, {"median", result.median}, {"worst", result.worst}, {"submit", result.submit}}},
          {"join_s", {{"median", result.join}, {"worst", result.worst_join}}},
          {"join_elsewhere_s", {{"median", result.work}, {"worst", result.worst_work}}},
          {"bytes_per_client", {{"both_ends", result.memory}, {"server", result.server_memory}}},
          {"down_per_client_and_tick", {{"datagrams", result.datagrams}, {"bytes", result.bytes}}}};
}

Json join_point(Request& request) {
  sim::study::JoinCase of;
  of.side = request.get<std::uint32_t>("side", of.side);
  of.round_trip = request.get<std::int64_t>("round_trip_us");
  of.rate = request.get<double>("rate_bit_per_s");
  of.loss = request.get<double>("loss", 0);
  of.jitter = request.get<std::int64_t>("jitter_us", 0);
  of.queue = request.get<std::int64_t>("queue_us");
  of.limit = request.get<std::uint64_t>("limit_bit_per_s", 0);
  of.sealed = request.get("sealed", false);
  of.seed = request.get<std::uint64_t>("seed", 1);
  request.check_all_known();
  if (of.side < 2 || of.side > 1000 || !(of.rate > 0) || of.queue < 0)
    refuse_request("side, rate or queue of a join is out of range", "Give a side of 2 to 1000 vertices, and a rate above 0.");
  const sim::study::JoinResult result = need(sim::study::run_join(of), "join");
  return {{"declaration_bytes", result.declaration},
          {"live_s", result.live},
          {"datagrams_per_piece", result.sent},
          {"longest_without_progress_s", result.longest_silence},
          {"live_client", {{"wait_99_s", result.waits}, {"wait_worst_s", result.worst}, {"dropped", result.lost}}}};
}

}  // namespace tactus::study
