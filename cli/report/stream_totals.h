// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <tactus/metrics/rates.h>
#include <tactus/player.h>

namespace tactus::cli {

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

}  // namespace tactus::cli
