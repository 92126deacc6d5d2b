// SPDX-License-Identifier: Apache-2.0
#include <tactus/metrics/rates.h>

#include <algorithm>
#include <cmath>

namespace tactus {

void RateMetrics::add(Reason reason, std::uint64_t update_count, std::uint64_t byte_count, bool key) noexcept {
  ++packets[static_cast<std::size_t>(reason)];
  updates += update_count;
  bytes += byte_count;
  keys += key ? 1 : 0;
}

Reason strongest_reason(const DecodedPacket& packet) noexcept {
  Reason strongest = Reason::request;
  for (const RigidUpdate& update : packet.updates) strongest = std::max(strongest, update.reason);
  return strongest;
}

void DeformableRates::add(std::size_t packet_bytes, std::uint64_t update_count, bool key, Layer layer) {
  sizes.push_back(static_cast<std::uint32_t>(packet_bytes));
  bytes += packet_bytes;
  updates += update_count;
  keys += key ? 1 : 0;
  if (layer == Layer::all) return;
  OfLayer& of = layers[static_cast<std::size_t>(layer)];
  ++of.packets;
  of.bytes += packet_bytes;
}

std::uint32_t DeformableRates::quantile(double fraction) const {
  if (sizes.empty()) return 0;
  std::vector<std::uint32_t> sorted = sizes;
  const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(sorted.size())));
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(sorted.begin(), at, sorted.end());
  return *at;
}

}  // namespace tactus
