// SPDX-License-Identifier: Apache-2.0
/// Which part of the scene a packet belongs to. spec/60-mesh.md section 1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/scene/scene_syntax.h>

namespace tactus {

/// 0 is the rigid objects together, i + 1 is mesh i.
struct PartPacket {
  std::size_t part = 0;
  std::span<const std::uint8_t> bytes;  ///< for RigidDecoder or DeformableDecoder
};

/// Packets of this stream begin with the number of their part: there is more than one.
bool has_part_byte(const StreamHeader& header) noexcept;

/// Split a packet of the stream. Without a part byte, and in a scene where nothing can move, all of it is returned.
/// err  truncated R-PKT-6 the byte is missing; invalid R-PKT-6 there is no such part.
Result<PartPacket> split_part(const StreamHeader& header, std::span<const std::uint8_t> packet) noexcept;

/// Puts the number of its part in front of a packet, in streams that have such numbers.
class PartJoiner {
 public:
  explicit PartJoiner(const StreamHeader& header);
  /// in   packet  of RigidEncoder or DeformableEncoder.   out  for the stream; valid until the next call.   no allocation
  std::span<const std::uint8_t> join(std::size_t part, std::span<const std::uint8_t> packet) noexcept;

 private:
  std::vector<std::uint8_t> joined_;  // empty: packets stay as they are
};

}  // namespace tactus
