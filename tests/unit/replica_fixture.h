// SPDX-License-Identifier: Apache-2.0
/// Replicas of one object that are handed updates without a bitstream.
#pragma once

#include <cstdint>

#include <tactus/client/replica.h>
#include <tactus/rigid/rigid_states.h>
#include "tests/unit/rigid_fixture.h"
#include "tests/unit/smooth_motion.h"

namespace tactus::testing {

/// Updates of any states.
class Feeder {
 public:
  explicit Feeder(Interpolation mode, const ThesisComponent* thesis = nullptr)
      : scene_(scene_of(1)), replica_(*scene_, {.interpolation = mode}, {}, nullptr, thesis) {}

  void update(std::int64_t tick, const Vec3& position, const Vec3& velocity, const Quat& rotation = {},
              const Vec3& angular_velocity = {}) {
    update_at(tick, tick, position, velocity, rotation, angular_velocity);
  }
  /// A packet of tick `tick`, applied at `now`.
  void update_at(std::int64_t now, std::int64_t tick, const Vec3& position, const Vec3& velocity, const Quat& rotation = {},
                 const Vec3& angular_velocity = {}) {
    const RigidState state = to_grid({{position, rotation}, velocity, angular_velocity}, tick, scene_->grid).value();
    const RigidUpdate named{0, Reason::visual, 0};
    DecodedPacket packet;
    packet.tick = tick;
    packet.updates = {&named, 1};
    replica_.apply(packet, {tick, PagedArray<RigidState>(1, 1, [&](std::size_t) { return state; })}, now);
  }
  Pose shown(std::int64_t tick) const { return to_pose(replica_.pose(0, tick), scene_->grid.position); }

 private:
  SharedScene scene_;
  Replica replica_;
};

/// An update along a smooth motion; packets arrive in any order, or not at all.
struct Arrival {
  std::uint64_t number;
  std::int64_t tick;
};

class NumberedFeeder {
 public:
  explicit NumberedFeeder(Interpolation mode = Interpolation::playout, const ThesisComponent* thesis = nullptr)
      : replica_(*scene_, {.interpolation = mode}, {}, nullptr, thesis) {}
  void take(const Arrival& arrival, std::int64_t now = 0) {
    const RigidState state = along(arrival.tick, true);
    const RigidUpdate named{0, Reason::visual, 0};
    DecodedPacket packet;
    packet.number = arrival.number;
    packet.tick = arrival.tick;
    packet.updates = {&named, 1};
    replica_.apply(packet, {arrival.tick, PagedArray<RigidState>(1, 1, [&](std::size_t) { return state; })}, now);
  }
  RigidPose shown(std::int64_t tick) const { return replica_.pose(0, tick); }
  RigidPose reckoned(std::int64_t from, std::int64_t tick) const { return RigidPredictor(*scene_).pose(along(from, true), tick); }
  RigidPose interpolated(std::int64_t from, std::int64_t to, std::int64_t tick) const {
    return interpolate_gap(*scene_, along(from, true), along(to, true), tick);
  }

 private:
  SharedScene scene_ = scene_of(1);
  Replica replica_;
};

}  // namespace tactus::testing
