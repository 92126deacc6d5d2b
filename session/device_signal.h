// SPDX-License-Identifier: Apache-2.0
/// The forward channel: where a participant's device is, tick by tick. A device is coded as the one object of a scene of its own, so that
/// all that holds for rigid objects holds for it: dead reckoning, bounds, baselines, the same integers at both ends.
/// spec/65-signal.md section 2.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <tactus/base/geometry.h>
#include <tactus/receiver.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/sender.h>

namespace tactus {

/// When the device, whose scene is device_scene(), is sent.
struct DeviceCoding {
  double position = 1e-4;        ///< [m] largest error in free space
  double rotation = 0.02;        ///< [rad] largest error of the orientation
  double weber_fraction = 0.04;  ///< p: in contact, the error of the force that the error of the position causes, eq. 2.8
  bool every_tick = false;       ///< every sample, as exact as the grid
};

/// What the device feels: force = stiffness * (proxy - position of the device).
struct DeviceContact {
  Vec3 proxy;            ///< [m] world
  double stiffness = 0;  ///< [N/m] > 0
};

/// Options of the Sender of a device.
SenderOptions device_sender_options(const DeviceCoding& coding) noexcept;

/// Samples of a device as the truth that its Sender codes. A device that does not sense its velocity gets one from its
/// positions of the last 8 ms.
class DeviceTruth {
 public:
  /// in   velocity  the samples have one
  DeviceTruth(std::uint32_t tick_rate, bool velocity) noexcept : tick_rate_(tick_rate), senses_velocity_(velocity) {}

  /// in   tick  rising.   out  valid until the next call.   time O(1), no allocation
  Truth of(std::int64_t tick, const DeviceSample& sample, const std::optional<DeviceContact>& contact) noexcept;

 private:
  static constexpr std::size_t kSamples = 32;  // at most, from which a velocity is taken
  struct TimedPosition {
    std::int64_t tick = 0;
    Vec3 position;
  };
  Vec3 slope() const noexcept;

  std::uint32_t tick_rate_;
  bool senses_velocity_;
  std::array<TimedPosition, kSamples> positions_{};  // a ring
  std::size_t count_ = 0;
  RigidSample sample_;
  Contact contact_;
};

/// A device whose newest packet brought this state.
/// pre  tick >= state.tick
DeviceSample device_of(const Scene& scene, const RigidState& state, std::int64_t tick, std::uint32_t buttons) noexcept;

/// The device as its Receiver shows it.
/// in   buttons  as of that tick
DeviceSample device_at(Receiver& receiver, std::int64_t tick, std::uint32_t buttons) noexcept;

}  // namespace tactus
