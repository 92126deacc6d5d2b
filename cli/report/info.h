// SPDX-License-Identifier: Apache-2.0
/// What `tactus info` prints: schema info.json.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <tactus/metrics/rates.h>
#include <tactus/player.h>
#include <tactus/trace/frame.h>

namespace tactus::sim {
struct Scene;
}

namespace tactus::cli {

// ==== stream totals ====

/// Sizes of packets.
struct Sizes {
  std::uint64_t packets = 0, bytes = 0;
  std::size_t smallest = SIZE_MAX, largest = 0;

  void add(std::size_t size) {
    ++packets;
    bytes += size;
    smallest = std::min(smallest, size);
    largest = std::max(largest, size);
  }
};

/// Totals over a stream's packets.
struct StreamTotals {
  explicit StreamTotals(const Scene& scene) : meshes(scene.deformables.size()) {}

  RateMetrics traffic;
  std::array<std::uint64_t, 8> levels{};
  std::int64_t last_tick = 0;
  Sizes rigid;
  std::vector<DeformableRates> meshes;
  LoadRates loads;

  bool is_empty() const {
    return rigid.packets + loads.packets == 0 &&
           std::ranges::all_of(meshes, [](const DeformableRates& m) { return m.sizes.empty(); });
  }
  void add(const PlayedPacket& p) {
    last_tick = p.tick;
    if (p.substream > meshes.size()) return loads.add(p.bytes, p.loads);
    if (p.substream > 0) return meshes[p.substream - 1].add(p.bytes, p.vertices, p.key, p.layer);
    traffic.add(strongest_reason(p), p.updates.size(), p.bytes, p.key);
    for (const RigidUpdate& u : p.updates) ++levels[u.level % levels.size()];
    rigid.add(p.bytes);
  }
};

// ==== info json ====
// What `tactus info` prints: schema info.json.

struct Value;

struct StreamEnd {
  std::optional<Error> error{};  ///< that the reading ended with
  bool complete = false;         ///< the trailer is there
};
Value stream_info_value(const Player& player, const StreamTotals& totals, std::uint64_t file_bytes, const StreamEnd& end);
Value packet_info_value(const PlayedPacket& played, const Scene& scene);

/// What reading a trace to its end showed.
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
