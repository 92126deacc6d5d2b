// SPDX-License-Identifier: Apache-2.0
/// Which device is meant: one that is connected, a virtual hand, a recording.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tactus/device/device.h>
#include <tactus/device/force_guard.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/user/hand.h>
#include "cli/command.h"

namespace tactus::cli {

// ==== virtual device ====
// The virtual hand of a scene's user as a device: it moves along its path, and yields to the force that is written.

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
  Vec3 force_{};
  device::Time begin_ = -1;
  std::int64_t ticks_ = 0;
  std::atomic<bool> is_halted_{false};
};

// ==== device choice ====
// Devices by name: which there are, and the options with which a command takes one.

/// The backends of this program for hardware.
const std::vector<std::unique_ptr<device::Backend>>& backends();

struct DeviceArguments {
  std::string name = "virtual";  ///< BACKEND[:WHICH]
  device::OpenOptions open{};
  double force = 0;  ///< [N] 0: what the device can hold
  bool passivity = false;
  double scale = 0;          ///< of its frame; 0: that of the scene
  double playback_rate = 1;  ///< of a recording
  bool loops = false;
  std::uint64_t seed = 1;  ///< of a virtual hand

  std::string backend() const { return name.substr(0, name.find(':')); }
  device::GuardLimits limits() const { return {.force = force, .passivity = passivity}; }
};
void add_device_options(Command& command, DeviceArguments& arguments);
/// Of a command in which the device touches a scene.
void add_scale(Command& command, DeviceArguments& arguments);
/// The user's device as typed, with its largest force.
void scale_device(sim::SceneUser& user, const DeviceArguments& arguments);

/// The file that a replayed device is read from; empty: it is no such device.
std::string replayed_file(const DeviceArguments& arguments);
/// err  the device cannot hold --force-limit
Outcome check_force(const DeviceArguments& arguments, const device::Capabilities& device);

/// err  the device has no position: its reports are only recorded
Outcome check_position(const device::Capabilities& device);

/// What a device said, or the servo loop about it. Nothing of it is the operating system's.
tl::unexpected<Failure> refuse_device(const std::string& name, const Error& error);

/// Where a device's frame is in the world. The probe moves `scale` times as far as the device, and the device exerts its force / scale.
struct DeviceFrame {
  Vec3 origin{};  ///< [m]
  double scale = 1;

  DeviceSample to_world(DeviceSample sample) const noexcept {
    sample.position = origin + scale * sample.position;
    sample.velocity = scale * sample.velocity;
    return sample;
  }
};

/// An open device.
struct ChosenDevice {
  std::unique_ptr<device::Device> device;
  VirtualDevice* hand = nullptr;  ///< it is a virtual one
  DeviceFrame frame{};            ///< the world's, of a virtual hand or a recording; else its origin is where the user begins
};
/// in   scene, user  that the device touches; none: a virtual hand moves as in the scene that its name names, or push-1dof
tl::expected<ChosenDevice, Failure> open_device(const DeviceArguments& arguments, const sim::Scene* scene, std::size_t user);

}  // namespace tactus::cli
