// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/device_signal.h>

#include <algorithm>
#include <cmath>

#include <tactus/rigid/rigid_predictor.h>

namespace tactus {

SenderOptions device_sender_options(const DeviceCoding& coding) noexcept {
  SenderOptions options;
  options.triggers = {.reduction = coding.every_tick ? Reduction::none : Reduction::dead_reckoning,
                      .heartbeat = 0,
                      .visual_position = coding.position,
                      .visual_rotation = coding.rotation,
                      .haptic = HapticRule::isotropic,
                      .weber_fraction = coding.weber_fraction};
  options.policy = {.key_interval = 0, .baseline = Baseline::acknowledged};
  return options;
}

/// [m/tick] Least-squares line through the samples of the last 8 ms, or three: longer windows lag behind a hand, shorter ones follow the
/// noise of its sensor.
Vec3 DeviceTruth::slope() const noexcept {
  const std::size_t kept = std::min(count_, kSamples);
  const auto back_by = [&](std::size_t back) -> const TimedPosition& { return positions_[(count_ - 1 - back) % kSamples]; };
  const auto is_recent = [&](const TimedPosition& p) { return (back_by(0).tick - p.tick) * 1000 < std::int64_t{8} * tick_rate_; };
  std::size_t count = std::min<std::size_t>(kept, 3);
  while (count < kept && is_recent(back_by(count))) ++count;
  if (count < 2) return {};
  double mean = 0, square = 0;
  Vec3 centre;
  for (std::size_t i = 0; i < count; ++i) {
    mean += static_cast<double>(back_by(i).tick - back_by(0).tick) / static_cast<double>(count);
    centre = centre + (1.0 / static_cast<double>(count)) * back_by(i).position;
  }
  Vec3 sum;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(back_by(i).tick - back_by(0).tick) - mean;
    sum = sum + t * (back_by(i).position - centre);
    square += t * t;
  }
  return square > 0 ? (1 / square) * sum : Vec3{};
}

Truth DeviceTruth::of(std::int64_t tick, const DeviceSample& sample, const std::optional<DeviceContact>& contact) noexcept {
  sample_.pose = {sample.position, sample.orientation};
  if (senses_velocity_) {
    sample_.velocity = sample.velocity;
  } else {
    if (is_finite(sample.position))
      positions_[count_++ % kSamples] = {tick, sample.position};  // else only this sample is refused
    sample_.velocity = static_cast<double>(tick_rate_) * slope();
  }
  // The error of the device is that of the other end of the spring: the force and its threshold are the same.
  if (contact) {
    contact_.kind = ContactKind::spring;
    contact_.device = contact->proxy;
    contact_.stiffness = contact->stiffness;
  }
  return {.objects = {&sample_, 1}, .contacts = {&contact_, contact ? 1u : 0u}, .deformables = {}};
}

DeviceSample device_of(const Scene& scene, const RigidState& state, std::int64_t tick, std::uint32_t buttons) noexcept {
  const Pose pose = to_pose(RigidPredictor(scene).pose(state, tick), scene.grid.position);
  DeviceSample out{.position = pose.position, .orientation = pose.rotation, .buttons = buttons};
  if (tick >= state.tick + scene.max_extrapolation) return out;  // it stands still
  const double unit = std::ldexp(1.0, -scene.grid.velocity);
  out.velocity = {unit * state.velocity[0], unit * state.velocity[1], unit * state.velocity[2]};
  return out;
}

DeviceSample device_at(Receiver& receiver, std::int64_t tick, std::uint32_t buttons) noexcept {
  const RigidState& state = receiver.object(0);
  return device_of(*receiver.scene(), state, std::max(tick, state.tick), buttons);
}

}  // namespace tactus
