// SPDX-License-Identifier: Apache-2.0
/// Any bytes as motions, contacts, settings and viewpoints of a client: what the sender takes stays inside its bounds at the
/// receiver, what breaks a rule is where it was last.
#include <algorithm>
#include <cmath>
#include <vector>

#include <tactus/rigid/device_path.h>
#include <tactus/tactus.h>
#include "tests/fuzz/motions.h"
#include "tests/fuzz/require.h"

namespace {

using namespace tactus;

/// Those of a level of detail.
RigidTriggers scaled(RigidTriggers t, std::uint8_t lod) {
  for (double* bound : {&t.visual_position, &t.visual_rotation, &t.weber_fraction, &t.perceptual_fraction, &t.cone_angle,
                        &t.fixed_position, &t.fixed_rotation})
    *bound = std::ldexp(*bound, lod);
  return t;
}

void check_bounds(const RigidTriggers& t, Receiver& receiver, std::int64_t tick, const RigidSample& truth,
                  std::span<const Contact> contacts) {
  const GridExponents& grid = receiver.scene()->grid;
  const Pose shown = to_pose(receiver.replica().pose(0, tick), grid.position);
  const double error = norm(shown.position - truth.pose.position), angle = angle_between(shown.rotation, truth.pose.rotation);
  require(error <= t.visual_position && angle <= t.visual_rotation);
  // A bound of force that is finer than the grid means the nearest point on it.
  const bool is_nearest = error <= std::ldexp(1.0, -grid.position) && angle <= std::ldexp(8.0, -grid.rotation);
  for (const Contact& c : contacts)
    require(is_nearest || haptic_ratio(t, contact_force(c, truth.pose), contact_force(c, shown)) <= 1);
  if (t.haptic == HapticRule::fixed && !contacts.empty() && contacts[0].kind != ContactKind::none)
    require(error <= t.fixed_position && angle <= t.fixed_rotation);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ByteReader in({data, size});
  SceneSpec spec;
  const std::uint8_t choice = in.u8();
  spec.baseline_span = static_cast<std::uint8_t>(1 + choice % 64);
  if (choice & 64) spec.motion = {{0, 0, -1285816}, 321454};
  spec.is_smoothed = choice >= 128;
  if ((choice & 96) == 96) spec.driven = {{{1075200, 116053, {286331, 286331, 286331}, 128, 1049}}};
  spec.objects.push_back({"o", Dof::all, {}});
  const std::uint8_t rule = in.u8();
  if (rule >= 128) spec.interest = {1 << 20, 1 << 24};  // 0.25 m and 4 m
  const SharedScene scene = Scene::create(std::move(spec)).value();
  SenderOptions options;
  options.triggers.haptic = static_cast<HapticRule>(rule % 5);
  options.triggers.reduction = static_cast<Reduction>(in.u8() % 3);
  options.triggers.weber_fraction = 0.001 * in.u8();
  options.triggers.perceptual_fraction = std::min(1.0, 10 * options.triggers.weber_fraction);
  options.triggers.visual_position = 1e-5 * in.u16();
  options.triggers.visual_rotation = 1e-4 * in.u16();
  options.policy.key_interval = 0.01 * in.u8();
  const auto path = std::make_shared<DevicePath>(device_scene(*scene).value());
  path->shift(0, 0);
  const auto known = scene->driven ? path : nullptr;
  auto sender = Sender::create(scene, options, nullptr, known);
  if (!sender) return 0;
  auto receiver = Receiver::create(scene, {}, known).value();
  RigidSample sample;
  for (std::int64_t tick = 0; in.ok(); tick += 1 + in.u8() % 8) {
    RigidSample next = sample;
    move(in, next);
    std::vector<Contact> contacts;
    if (in.u8() & 1) contacts.push_back(contact(in, next.pose));
    if (scene->driven && !contacts.empty())
      if (const auto device = to_grid({{contacts[0].device, {}}, {}, {}}, tick, scene->grid))
        path->add(static_cast<std::uint64_t>(tick) + 1, *device);
    if (rule >= 192) {  // below that the client never reports
      const Vec3 viewpoint{0.1 * in.u8(), 0, 0};
      sender->set_viewpoints({&viewpoint, in.u8() < 250 ? 1u : 0u});
    }
    const Pose before = to_pose(receiver.replica().pose(0, tick), scene->grid.position);
    const auto packets = sender->encode(tick, {.objects = {&next, 1}, .contacts = contacts});
    require(packets.has_value());
    bool is_held = false;
    for (const HeldPart& held : sender->held()) {
      require(held.index == 0 && held.since <= tick);
      if (held.part == TruthPart::object) is_held = true;
      contacts.clear();  // one that is bad, or of an object that is held
    }
    if (is_held) sample.velocity = sample.angular_velocity = {};
    else sample = next;
    for (const Packet& packet : *packets) require(receiver.push(packet.number, packet.bytes).has_value());
    require(receiver.state_hash(0) == sender->state_hash(0));
    const std::uint8_t lod = receiver.replica().lod(0, tick);
    require(scene->interest.has_value() || lod == 0);
    const Vec3 displacement = sample.pose.position - before.position;  // longer ones than an update can name take two
    const bool is_near = std::abs(displacement.x) < 511 && std::abs(displacement.y) < 511 && std::abs(displacement.z) < 511;
    if (lod != kOutOfInterest && is_near) check_bounds(scaled(options.triggers, lod), receiver, tick, sample, contacts);
  }
  return 0;
}
