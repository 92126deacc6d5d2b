// SPDX-License-Identifier: Apache-2.0
/// What `tactus info` prints: schema info.json.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <tactus/trace/frame.h>
#include "cli/report/stream_totals.h"

namespace tactus::sim {
struct Scene;
}

namespace tactus::cli {

struct Value;

struct StreamEnd {
  std::optional<Error> error{};  ///< that the reading ended with
  bool complete = false;         ///< the trailer is there
};
Value stream_info_value(const Player& player, const StreamTotals& totals, std::uint64_t file_bytes, const StreamEnd& end);
Value packet_info_value(const PlayedPacket& played, const Scene& scene);

/// What reading a trace to its end told.
struct TraceTotals {
  std::uint64_t frames = 0;
  std::int64_t first = 0, last = 0;
  bool complete = false;
  std::vector<std::uint64_t> shapes{};  ///< per mesh: how many are new
};
Value trace_info_value(const TraceInfo& trace, const TraceTotals& totals);

#ifdef TACTUS_HAS_SIM
Value scene_info_value(const sim::Scene& scene);
#endif

}  // namespace tactus::cli
