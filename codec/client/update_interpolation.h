// SPDX-License-Identifier: Apache-2.0
/// What component thesis puts in the place of a replica's own way to show an update. Internal to the library.
#pragma once

#include <cstdint>

#include <tactus/packet/packet.h>
#include <tactus/rigid/rigid_states.h>

namespace tactus {

/// How rigid objects pass to their updates. The replica's own way is to show an update at once.
class UpdateInterpolation {
 public:
  UpdateInterpolation() = default;
  UpdateInterpolation(const UpdateInterpolation&) = delete;
  UpdateInterpolation& operator=(const UpdateInterpolation&) = delete;
  virtual ~UpdateInterpolation() = default;

  /// As those of Replica.
  virtual void apply(const DecodedPacket& packet, const RigidStates& states, std::int64_t arrival) noexcept = 0;
  virtual RigidPose pose(std::uint32_t object, std::int64_t now) const noexcept = 0;
  virtual std::uint8_t lod(std::uint32_t object) const noexcept = 0;
};

}  // namespace tactus
