// SPDX-License-Identifier: Apache-2.0
/// Which objects of a scene a packet belongs to. spec/25-packet.md section 1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <tactus/base/result.h>
#include <tactus/scene/scene.h>

namespace tactus {

/// A packet of one substream: 0 is that of the rigid objects together, i + 1 that of deformable object i, the next that of the loads.
struct SubstreamPacket {
  std::size_t substream = 0;
  std::span<const std::uint8_t> bytes;  ///< after the substream number
};

/// True if packets of this scene begin with their substream number, that is, if there are several substreams.
bool has_substream_number(const Scene& scene) noexcept;

inline bool is_of_deformable(const Scene& scene, std::size_t substream) noexcept {
  return substream > 0 && substream <= scene.deformables.size();
}

/// Split off the substream number. Without a number, and in a scene where nothing can move, all bytes are the packet.
/// err  truncated R-PKT-6 the number is missing; invalid R-PKT-6 there is no such substream.
Result<SubstreamPacket> split_substream(const Scene& scene, std::span<const std::uint8_t> packet) noexcept;

}  // namespace tactus
