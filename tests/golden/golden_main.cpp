// SPDX-License-Identifier: Apache-2.0
/// Prints `name hash` lines: every byte that an encoder wrote and every state that a decoder and a replica reached, for seeded motions.
/// The motions use only operations that IEEE 754 defines exactly (+ - * / and square root), so that the input is the same everywhere.
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/rigid/device_path.h>
#include <tactus/tactus.h>
#include <tactus/thesis/thesis.h>
#include "tests/golden/golden.h"

namespace {

using namespace tactus;

constexpr double kTick = 1e-3;

/// Uniform in -1..1 with 2^-53 steps.
double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * (1.0 / 4503599627370496.0) - 1; }

/// A body on a spring, kicked now and then; its spin is kicked too. Locked axes stay put.
class Body {
 public:
  Body(std::uint64_t seed, std::uint8_t dof) : random_(seed), dof_(dof) {}

  RigidSample step() {
    if (random_() % 128 == 0) kick(sample_.velocity, dof_, 0.4);
    if (random_() % 128 == 0) kick(sample_.angular_velocity, static_cast<std::uint8_t>(dof_ >> 3), 8);
    Vec3& x = sample_.pose.position;
    sample_.velocity = sample_.velocity - (4 * kTick) * x;
    x = x + kTick * sample_.velocity;
    const Vec3& w = sample_.angular_velocity;
    Quat& q = sample_.pose.rotation;
    const Quat rate = Quat{0, w.x, w.y, w.z} * q;
    const double h = 0.5 * kTick;
    q = {q.w + h * rate.w, q.x + h * rate.x, q.y + h * rate.y, q.z + h * rate.z};
    const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    q = {q.w / length, q.x / length, q.y / length, q.z / length};
    return sample_;
  }

 private:
  void kick(Vec3& v, std::uint8_t axes, double size) {
    v = {axes & 1 ? size * uniform(random_) : 0, axes & 2 ? size * uniform(random_) : 0, axes & 4 ? size * uniform(random_) : 0};
  }

  std::mt19937_64 random_;
  std::uint8_t dof_;
  RigidSample sample_;
};

Contact press(std::uint32_t object, const Pose& pose, double depth) {
  Contact contact;
  contact.kind = ContactKind::surface;
  contact.object = object;
  contact.point = {0.004, -0.002, 0.02};
  contact.stiffness = 630;
  contact.device = to_world(pose, contact.point) - depth * rotate(pose.rotation, contact.normal);
  return contact;
}

struct Case {
  const char* name;
  std::vector<std::uint8_t> dofs;
  HapticRule rule;
  double p;
  Reduction reduction = Reduction::dead_reckoning;
  RigidProfile profile = RigidProfile::thesis;
  MotionPhysics motion{};
  bool is_driven = false;
};

constexpr DrivenPhysics kDriven{0.25, {1e-4, 2e-4, 1.5e-4}, 630, 68, 0.5, 1};

/// Three lines per case, or nothing and false when a codec call failed.
bool run(const Case& c) {
  SceneBuilder builder;
  std::vector<Body> bodies;
  for (std::size_t i = 0; i < c.dofs.size(); ++i) {
    builder.rigid("body " + std::to_string(i), {},
                  {.dof = c.dofs[i], .driven = c.is_driven ? std::optional(kDriven) : std::nullopt});
    bodies.emplace_back(1000 + i, c.dofs[i]);
  }
  builder.rigid_profile(c.profile);
  builder.motion(c.motion);
  const auto scene = std::move(builder).build();
  if (!scene) return false;
  SenderOptions options;
  options.triggers.visual_position = 6e-3;
  options.triggers.haptic = c.rule;
  options.triggers.weber_fraction = c.p;
  options.triggers.reduction = c.reduction;
  ReceiverOptions smooth;
  smooth.limits.thesis = &thesis_component;
  smooth.replica.interpolation = c.profile == RigidProfile::main ? Interpolation::none : Interpolation::linear;
  const auto path = std::make_shared<DevicePath>(device_scene(**scene).value());
  path->shift(0, 0);
  const auto known = c.is_driven ? path : nullptr;
  auto sender = Sender::create(*scene, options, nullptr, known);
  auto receiver = Receiver::create(*scene, smooth, known);
  if (!sender || !receiver) return false;
  Fnv1a stream, states, shown;
  std::vector<RigidSample> samples(bodies.size());
  std::mt19937_64 random(7);
  double depth = 0.001;
  for (std::int64_t tick = 0; tick < 6000; ++tick) {
    for (std::size_t i = 0; i < bodies.size(); ++i) samples[i] = bodies[i].step();
    depth = 0.99 * depth + 0.01 * (0.001 + 0.0009 * uniform(random));
    const Contact contact = press(0, samples[0].pose, depth);
    const auto device = to_grid({{contact.device, {}}, {}, {}}, tick, (*scene)->grid);
    if (!device) return false;
    path->add(static_cast<std::uint64_t>(tick) + 1, *device);
    const auto packets = sender->encode(tick, {.objects = samples, .contacts = {&contact, tick % 1500 < 1000 ? 1u : 0u}});
    if (!packets) return false;
    for (const Packet& packet : *packets) {
      for (const std::uint8_t byte : packet.bytes) stream.add_byte(byte);
      const auto decoded = receiver->push(packet.number, packet.bytes);
      if (!decoded) return false;
      stream.add32(decoded->final_range);
      stream.add32(decoded->final_code);
      states.add64(receiver->state_hash(0));
    }
    shown.add64(receiver->replica().pose_hash(tick));
  }
  std::printf("%s stream %016" PRIx64 "\n%s states %016" PRIx64 "\n%s shown %016" PRIx64 "\n", c.name, stream.value(), c.name,
              states.value(), c.name, shown.value());
  return true;
}

}  // namespace

int main() {
  const Case cases[] = {
      {"slide", {Dof::x}, HapticRule::isotropic, 0.04},
      {"turn", {Dof::rz}, HapticRule::isotropic, 0.08},
      {"free", {Dof::all}, HapticRule::isotropic, 0.01},
      {"cone", {Dof::all}, HapticRule::cone, 0.18},
      {"fixed", {Dof::all}, HapticRule::fixed, 0.08},
      {"perceptual", {Dof::all}, HapticRule::perceptual, 0.08},
      {"visual", {Dof::all, Dof::none, Dof::all}, HapticRule::off, 0.08},
      {"crowd", std::vector<std::uint8_t>(40, Dof::all), HapticRule::isotropic, 0.04},
      {"every-tick", {Dof::all, Dof::translation}, HapticRule::off, 0.08, Reduction::none},
      {"smoothed", {Dof::all, Dof::x}, HapticRule::isotropic, 0.04, Reduction::dead_reckoning, RigidProfile::main},
      {"predictors",
       {Dof::all, Dof::translation},
       HapticRule::isotropic,
       0.3,
       Reduction::dead_reckoning,
       RigidProfile::thesis,
       {{0.5, 0, -1.5}, 0.25}},
      {"smoothed-predictors",
       {Dof::all, Dof::translation},
       HapticRule::isotropic,
       0.3,
       Reduction::dead_reckoning,
       RigidProfile::main,
       {{0.5, 0, -1.5}, 0.25}},
      {"driven",
       {Dof::all, Dof::translation},
       HapticRule::isotropic,
       0.08,
       Reduction::dead_reckoning,
       RigidProfile::main,
       {{0.5, 0, -1.5}, 0.25},
       true},
  };
  for (const Case& c : cases) {
    if (!run(c)) {
      std::fprintf(stderr, "%s: the codec refused its input\n", c.name);
      return 1;
    }
  }
  if (!golden::run_meshes()) {
    std::fputs("meshes: the codec refused its input\n", stderr);
    return 1;
  }
  if (!golden::run_bodies()) {
    std::fputs("bodies: the codec refused its input\n", stderr);
    return 1;
  }
  return 0;
}
