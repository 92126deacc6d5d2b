// SPDX-License-Identifier: Apache-2.0
#include <tactus/packet/substream.h>

#include <tactus/base/rule.h>

namespace tactus {

bool has_substream_number(const Scene& scene) noexcept {
  return scene.deformables.size() + (scene.moving().empty() ? 0 : 1) + (scene.loads ? 1 : 0) > 1;
}

Result<SubstreamPacket> split_substream(const Scene& scene, std::span<const std::uint8_t> packet) noexcept {
  if (!has_substream_number(scene)) return SubstreamPacket{scene.deformables.size(), packet};  // none or one
  if (packet.empty()) return fail(Errc::truncated, "R-PKT-6");
  const std::size_t number = packet[0];
  const bool exists = number == 0 ? !scene.moving().empty() : number <= scene.deformables.size() + (scene.loads ? 1 : 0);
  if (!exists) return fail(Errc::invalid, "R-PKT-6");
  return SubstreamPacket{number, packet.subspan(1)};
}

}  // namespace tactus
