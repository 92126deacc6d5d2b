// SPDX-License-Identifier: Apache-2.0
/// What `tactus info --json` prints: schema info.json.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>

#include <tactus/trace/frame.h>
#include "cli/report/stream_totals.h"

namespace tactus::sim {
struct Scene;
}

namespace tactus::cli {

struct StreamEnd {
  std::optional<Error> error{};  ///< that the reading ended with
  bool complete = false;         ///< the trailer is there
};
nlohmann::ordered_json stream_info_json(const Player& player, const StreamTotals& totals, std::uint64_t file_bytes,
                                        const StreamEnd& end);
nlohmann::ordered_json packet_info_json(const PlayedPacket& played);

/// What reading a trace to its end told.
struct TraceTotals {
  std::uint64_t frames = 0;
  std::int64_t first = 0, last = 0;
  bool complete = false;
  std::vector<std::uint64_t> shapes{};  ///< per mesh: how many are new
};
/// "2026-01-31 09:30:00 UTC"   in  time  [ns] since 1970-01-01 UTC
std::string text_of_wall_time(std::int64_t time);
nlohmann::ordered_json trace_info_json(const TraceInfo& trace, const TraceTotals& totals);

#ifdef TACTUS_HAS_SIM
nlohmann::ordered_json scene_info_json(const sim::Scene& scene);
#endif

}  // namespace tactus::cli
