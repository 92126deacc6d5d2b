// SPDX-License-Identifier: Apache-2.0
/// The virtual hand of a scene's user as a device: it moves along its path, and yields to the force that is written.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include <tactus/device/device.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/user/hand.h>

namespace tactus::cli {

class VirtualDevice final : public device::Device {
 public:
  /// in  scene, user  the user, by index; seed  of the session
  VirtualDevice(const sim::Scene& scene, std::size_t user, std::uint64_t seed);

  const device::Capabilities& capabilities() const noexcept override { return capabilities_; }
  /// The hand at `deadline`, one tick per millisecond since the first call.
  Result<device::Reading> read(device::Time deadline) noexcept override;
  Result<void> write(const device::GuardedForce& force) noexcept override;
  void halt() noexcept override { is_halted_ = true; }

  /// Where the hand sees the object that it looks at; before the first call, where the scene puts it.
  void watch(const Pose& object) noexcept { watched_ = object; }

 private:
  device::Capabilities capabilities_;
  sim::Hand hand_;
  Pose watched_;
  DeviceSample sample_;
  Vec3 felt_{};
  device::Time begin_ = -1;
  std::int64_t ticks_ = 0;
  std::atomic<bool> is_halted_{false};
};

}  // namespace tactus::cli
