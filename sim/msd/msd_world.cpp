// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/msd/msd_world.h>

#include <cmath>

namespace tactus::sim {
namespace {

constexpr double kFarthest = 1e4;  // [m]

MsdLoopOptions loop_options(const Scene& scene, const SceneMsd& spec) {
  MsdLoopOptions out{.object = spec.object,
                     .tick = kTick,
                     .divider = spec.rate,
                     .client = Approach::linear,  // else b_c would answer every new surface with a blow
                     .coupling = Coupling::pressing,
                     .users = {}};
  if (scene.touch)
    out.users.assign(scene.users.size(), MsdUser{.server_stiffness = scene.touch->stiffness,
                                                 .client_stiffness = scene.touch->stiffness,
                                                 .client_damping = spec.touch_damping});
  return out;
}

/// The body whose surface the probe is below: the one touched before, else the first.
template <class Penetration>
std::optional<std::size_t> touched_now(const std::optional<std::size_t>& before, std::size_t bodies, Penetration&& penetration) {
  if (before && penetration(*before) > 0) return before;
  for (std::size_t i = 0; i < bodies; ++i)
    if (penetration(i) > 0) return i;
  return std::nullopt;
}

}  // namespace

MsdWorld::MsdWorld(const Scene& scene)
    : server_(scene.users.size()),
      client_(scene.users.size()),
      first_(static_cast<std::uint32_t>(scene.objects.size())),
      stiffness_(scene.touch ? scene.touch->stiffness : 0) {
  for (const SceneMsd& spec : scene.msds) bodies_.push_back({spec, MsdLoop(loop_options(scene, spec))});
}

Result<std::unique_ptr<MsdWorld>> MsdWorld::create(const Scene& scene) {
  std::unique_ptr<MsdWorld> world(new MsdWorld(scene));
  const double total = world->stiffness_ * static_cast<double>(scene.users.size());
  for (const SceneMsd& spec : scene.msds)
    if (total >= critical_stiffness(spec.object, spec.rate * kTick)) return fail(Errc::invalid, "R-SIM-3");
  return world;
}

void MsdWorld::observe(std::span<RigidSample> objects) noexcept {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    auto& [spec, loop] = bodies_[i];
    loop.begin_tick();
    objects[i] = {.pose = {spec.position - loop.surface() * spec.normal, {}},
                  .velocity = -loop.velocity() * spec.normal,
                  .angular_velocity = {}};
  }
}

Touch MsdWorld::touch_server(std::size_t user, const std::optional<Vec3>& device) noexcept {
  Touched& touched = server_[user];
  touched = device ? touched_now(touched, bodies_.size(),
                                 [&](std::size_t i) { return bodies_[i].depth(*device) - bodies_[i].loop.surface(); })
                   : std::nullopt;
  Touch out{};
  if (device) out.contact.device = out.proxy = *device;
  if (!touched) return out;
  const auto& [spec, loop] = bodies_[*touched];
  const double depth = bodies_[*touched].depth(*device);
  out.force = -loop.press(user, depth) * spec.normal;
  out.proxy = *device + (depth - loop.surface()) * spec.normal;
  out.contact = {.kind = ContactKind::surface,
                 .object = first_ + static_cast<std::uint32_t>(*touched),
                 .point = out.proxy - (spec.position - loop.surface() * spec.normal),
                 .normal = spec.normal,
                 .device = *device,
                 .stiffness = stiffness_};
  return out;
}

Vec3 MsdWorld::touch_client(std::size_t user, const std::optional<Vec3>& device, std::span<const Pose> poses) noexcept {
  Touched& touched = client_[user];
  const auto surface = [&](std::size_t i) { return bodies_[i].depth(poses[i].position); };
  touched = device ? touched_now(touched, bodies_.size(), [&](std::size_t i) { return bodies_[i].depth(*device) - surface(i); })
                   : std::nullopt;
  Vec3 force;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const double depth = touched == i ? bodies_[i].depth(*device) : kAway;
    force = force - bodies_[i].loop.feel(user, depth, surface(i)) * bodies_[i].spec.normal;
  }
  return force;
}

void MsdWorld::push(std::size_t object, const Vec3& force) noexcept {
  bodies_[object].loop.load(-dot(force, bodies_[object].spec.normal));
}

tl::expected<void, StepError> MsdWorld::step() {
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    bodies_[i].loop.end_tick();
    if (!(std::abs(bodies_[i].loop.surface()) < kFarthest))
      return tl::unexpected(StepError{Error{Errc::invalid_argument, "R-SIM-1", 0}, tick_, first_ + i});
  }
  ++tick_;
  return {};
}

}  // namespace tactus::sim
