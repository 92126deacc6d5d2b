// SPDX-License-Identifier: Apache-2.0
#include "cli/live/virtual_device.h"

#include <algorithm>

namespace tactus::cli {
namespace {

using device::kMillisecond;

constexpr double kReach = 0.1;            // [m] of its workspace round the start: what the path needs, and more
constexpr std::int64_t kMostSteps = 100;  // at once: after a longer pause the hand goes on where it was

device::Capabilities capabilities_of(const sim::SceneUser& user) {
  const Vec3 reach{kReach, kReach, kReach};
  device::Capabilities out;
  out.name = "virtual";
  out.model = "virtual hand";
  out.senses = {.velocity = false, .buttons = user.senses().buttons};
  out.buttons = out.senses.buttons ? 1 : 0;
  out.force_axes = 3;
  out.low = user.start - reach;
  out.high = user.start + reach;
  out.nominal_force = out.peak_force = user.device.max_force;
  out.rate = sim::kTickRate;
  return out;
}

}  // namespace

VirtualDevice::VirtualDevice(const sim::Scene& scene, std::size_t user, std::uint64_t seed)
    : capabilities_(capabilities_of(scene.users[user])),
      hand_(scene.users[user], scene.users[user].grip, sim::hand_seed(seed, user)),
      watched_(scene.users[user].object < scene.objects.size() ? scene.objects[scene.users[user].object].pose : Pose{}) {
  sample_.position = scene.users[user].start;
}

Result<device::Reading> VirtualDevice::read(device::Time deadline) noexcept {
  if (begin_ < 0) begin_ = deadline - kMillisecond;
  const std::int64_t due = (deadline - begin_) / kMillisecond;
  ticks_ = std::max(ticks_, due - kMostSteps);
  for (; ticks_ < due; ++ticks_) sample_ = hand_.step(is_halted_ ? Vec3{} : felt_, watched_);
  return device::Reading{.sample = sample_, .taken = begin_ + ticks_ * kMillisecond};
}

Result<void> VirtualDevice::write(const device::GuardedForce& force) noexcept {
  felt_ = force.value();
  is_halted_ = false;
  return {};
}

}  // namespace tactus::cli
