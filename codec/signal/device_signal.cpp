// SPDX-License-Identifier: Apache-2.0
#include <tactus/signal/device_signal.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <tactus/base/fixed.h>
#include <tactus/rigid/rigid_predictor.h>
#include <tactus/scene/scene_builder.h>

namespace tactus {

// ==== device path ====

std::int64_t DevicePath::add(std::uint64_t number, const RigidState& state) noexcept {
  const std::int64_t ahead = state.tick - passed_;
  if (ahead <= 0) return ahead;
  std::size_t overtook = 0;
  while (overtook < count_ && packet_at(overtook + 1).number > number) ++overtook;
  if (overtook == kPackets) return 0;
  next_ = (next_ + 1) % kPackets;
  count_ = std::min(count_ + 1, kPackets);
  for (std::size_t back = 1; back <= overtook; ++back) packet_at(back) = packet_at(back + 1);
  packet_at(overtook + 1) = {number, true, state};
  return ahead;
}

void DevicePath::shift(std::int64_t from, std::int64_t offset) noexcept {
  if (shift_count_ > 0 && shifts_[(shift_count_ - 1) % kShifts].from >= from) return;
  const std::int64_t least = device_tick(from - 1).value_or(std::numeric_limits<std::int64_t>::min());
  shifts_[shift_count_++ % kShifts] = {from, offset, least};
  if (!begins_) begins_ = from;
  ++revision_;
}

std::optional<std::int64_t> DevicePath::device_tick(std::int64_t tick) const noexcept {
  for (std::size_t back = 1; back <= std::min(shift_count_, kShifts); ++back) {
    const Shift& shift = shifts_[(shift_count_ - back) % kShifts];
    if (shift.from <= tick) return std::max(shift.least, tick - shift.offset);
  }
  return std::nullopt;
}

std::optional<DevicePath::Place> DevicePath::place(std::int64_t tick) const noexcept {
  const auto device = device_tick(tick);
  if (!device) return std::nullopt;
  for (std::size_t back = 1; back <= count_; ++back) {
    const Packet& packet = packet_at(back);
    if (packet.acts && packet.state.tick <= *device) return Place{packet.state, *device};
  }
  return std::nullopt;
}

std::optional<std::array<std::int32_t, 3>> DevicePath::at(std::int64_t tick) const noexcept {
  Known& known = known_[static_cast<std::size_t>(tick) % known_.size()];
  if (known.tick == tick && known.revision == revision_) return known.position;
  const auto found = place(tick);
  if (!found) return std::nullopt;
  const Vec3i out = RigidPredictor(*scene_).pose(found->state, found->tick).position;
  if (found->tick <= passed_) known = {tick, revision_, out};
  return out;
}

// ==== device signal ====

Result<SharedScene> device_scene(const SceneSpec& scene) {
  constexpr double kReach = 0.1;  // [s]: a device that is not heard of stands still then
  auto built = SceneBuilder(scene.tick_rate)
                   .rigid("device")
                   .rigid_profile(RigidProfile::thesis)
                   .grid(scene.grid)
                   .extrapolate(kReach)
                   .baselines(64)
                   .build();
  if (!built) return tl::unexpected(built.error().error);
  return *built;
}

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
  const auto place = [&](std::size_t back) -> const Place& { return places_[(count_ - 1 - back) % kSamples]; };
  const auto is_recent = [&](const Place& p) { return (place(0).tick - p.tick) * 1000 < std::int64_t{8} * tick_rate_; };
  std::size_t count = std::min<std::size_t>(kept, 3);
  while (count < kept && is_recent(place(count))) ++count;
  if (count < 2) return {};
  double mean = 0, square = 0;
  Vec3 centre;
  for (std::size_t i = 0; i < count; ++i) {
    mean += static_cast<double>(place(i).tick - place(0).tick) / static_cast<double>(count);
    centre = centre + (1.0 / static_cast<double>(count)) * place(i).position;
  }
  Vec3 sum;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(place(i).tick - place(0).tick) - mean;
    sum = sum + t * (place(i).position - centre);
    square += t * t;
  }
  return square > 0 ? (1 / square) * sum : Vec3{};
}

Truth DeviceTruth::of(std::int64_t tick, const DeviceSample& sample, const std::optional<DeviceContact>& contact) noexcept {
  sample_.pose = {sample.position, sample.orientation};
  if (senses_velocity_) {
    sample_.velocity = sample.velocity;
  } else {
    if (is_finite(sample.position)) places_[count_++ % kSamples] = {tick, sample.position};  // else only this sample is refused
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
  const RigidState& state = receiver.objects()[0];
  return device_of(*receiver.scene(), state, std::max(tick, state.tick), buttons);
}

}  // namespace tactus
