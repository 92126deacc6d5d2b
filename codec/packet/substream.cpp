// SPDX-License-Identifier: Apache-2.0
#include <tactus/packet/substream.h>

#include <algorithm>

namespace tactus {
namespace {

bool has_moving_objects(const StreamHeader& header) noexcept {
  return std::ranges::any_of(header.objects, [](const RigidObject& o) { return o.dof != Dof::none; });
}

}  // namespace

bool has_part_byte(const StreamHeader& header) noexcept {
  return header.meshes.size() + (has_moving_objects(header) ? 1 : 0) > 1;
}

PartJoiner::PartJoiner(const StreamHeader& header) {
  if (!has_part_byte(header)) return;
  std::size_t largest = max_packet_size(header);
  for (const DeformableObject& mesh : header.meshes) largest = std::max(largest, max_deformable_packet_size(mesh));
  joined_.resize(1 + largest);
}

std::span<const std::uint8_t> PartJoiner::join(std::size_t part, std::span<const std::uint8_t> packet) noexcept {
  if (joined_.empty()) return packet;
  joined_[0] = static_cast<std::uint8_t>(part);
  std::ranges::copy(packet, joined_.begin() + 1);
  return std::span<const std::uint8_t>(joined_).first(1 + packet.size());
}

Result<PartPacket> split_part(const StreamHeader& header, std::span<const std::uint8_t> packet) noexcept {
  if (!has_part_byte(header)) return PartPacket{header.meshes.size(), packet};  // none or one
  if (packet.empty()) return fail(Errc::truncated, "R-PKT-6");
  const std::size_t part = packet[0];
  const bool exists = part == 0 ? has_moving_objects(header) : part <= header.meshes.size();
  if (!exists) return fail(Errc::invalid, "R-PKT-6");
  return PartPacket{part, packet.subspan(1)};
}

}  // namespace tactus
