// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/msd/msd_objects.h>

#include <tactus/base/rule.h>

#include <cmath>

namespace tactus::sim {
namespace {

constexpr double kFarthest = 1e4;  // [m]

MsdLoopOptions loop_options(const Scene& scene, const SceneMsd& spec) {
  MsdLoopOptions out{.object = spec.object,
                     .tick = kTick,
                     .divider = spec.rate,
                     .client = Approach::linear,  // else b_c turns every new surface into a force peak
                     .coupling = Coupling::pressing,
                     .users = {}};
  if (scene.touch)
    out.users.assign(scene.users.size(), MsdUser{.server_stiffness = scene.touch->stiffness,
                                                 .client_stiffness = scene.touch->stiffness,
                                                 .client_damping = spec.touch_damping});
  return out;
}

std::vector<MsdBody> make_bodies(const Scene& scene) {
  std::vector<MsdBody> bodies;
  for (const SceneMsd& spec : scene.msds) bodies.push_back({spec, MsdLoop(loop_options(scene, spec))});
  return bodies;
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

MsdObjects::MsdObjects(const Scene& scene)
    : bodies_(make_bodies(scene)),
      touched_(scene.users.size()),
      forces_(scene.users.size()),
      first_(static_cast<std::uint32_t>(scene.objects.size())),
      stiffness_(scene.touch ? scene.touch->stiffness : 0) {}

Result<std::unique_ptr<MsdObjects>> MsdObjects::create(const Scene& scene) {
  std::unique_ptr<MsdObjects> objects(new MsdObjects(scene));
  const double total = objects->stiffness_ * static_cast<double>(scene.users.size());
  for (const SceneMsd& spec : scene.msds)
    if (total >= critical_stiffness(spec.object, spec.rate * kTick)) return fail(Errc::invalid, "R-SIM-3");
  return objects;
}

void MsdObjects::observe(TraceFrame& frame) noexcept {
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    auto& [spec, loop] = bodies_[i];
    loop.begin_tick();
    frame.objects[first_ + i] = {.pose = {spec.position - loop.surface() * spec.normal, {}},
                                 .velocity = -loop.velocity() * spec.normal,
                                 .angular_velocity = {}};
    frame.changed->push_back(first_ + i);
  }
}

Touch MsdObjects::touch(std::size_t user, const DeviceSample& device, bool held) noexcept {
  const Vec3& position = device.position;
  auto& touched = touched_[user];
  touched = held ? std::nullopt : touched_now(touched, bodies_.size(), [&](std::size_t i) {
    return bodies_[i].depth(position) - bodies_[i].loop.surface();
  });
  forces_[user] = {};
  Touch out{.contact = {}, .proxy = position, .force = {}};
  out.contact.device = position;
  if (!touched) return out;
  const auto& [spec, loop] = bodies_[*touched];
  const double depth = bodies_[*touched].depth(position);
  out.force = forces_[user] = -loop.press(user, depth) * spec.normal;
  out.proxy = position + (depth - loop.surface()) * spec.normal;
  out.contact = {.kind = ContactKind::surface,
                 .object = first_ + static_cast<std::uint32_t>(*touched),
                 .point = out.proxy - (spec.position - loop.surface() * spec.normal),
                 .normal = spec.normal,
                 .device = position,
                 .stiffness = stiffness_};
  return out;
}

void MsdObjects::push(std::size_t user, double fraction) noexcept {
  if (!touched_[user]) return;
  auto& [spec, loop] = bodies_[*touched_[user]];
  loop.load(dot(fraction * forces_[user], spec.normal));
}

tl::expected<void, Diagnostic> MsdObjects::step() {
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    bodies_[i].loop.end_tick();
    if (!(std::abs(bodies_[i].loop.surface()) < kFarthest))
      return tl::unexpected(Diagnostic{
          .error = fail(Errc::invalid_argument, "R-SIM-1").value(), .step = tick_, .kind = "object", .element = first_ + i});
  }
  ++tick_;
  return {};
}

MsdView::MsdView(const Scene& scene)
    : bodies_(make_bodies(scene)),
      touched_(scene.users.size()),
      first_(static_cast<std::uint32_t>(scene.objects.size())),
      stiffness_(scene.touch ? scene.touch->stiffness : 0) {
  for (const SceneMsd& msd : scene.msds) poses_.push_back({msd.position, {}});
}

Touch MsdView::touch(std::size_t user, const DeviceSample& device, bool held) noexcept {
  const Vec3& position = device.position;
  auto& touched = touched_[user];
  const auto surface = [&](std::size_t i) { return bodies_[i].depth(poses_[i].position); };
  touched = held ? std::nullopt
                 : touched_now(touched, bodies_.size(), [&](std::size_t i) { return bodies_[i].depth(position) - surface(i); });
  Touch out{.contact = {}, .proxy = position, .force = {}};
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const double depth = touched == i ? bodies_[i].depth(position) : kAway;
    out.force = out.force - bodies_[i].loop.feel(user, depth, surface(i)) * bodies_[i].spec.normal;
  }
  if (!touched) return out;
  const MsdBody& body = bodies_[*touched];
  out.proxy = position + (body.depth(position) - surface(*touched)) * body.spec.normal;
  out.contact = {.kind = ContactKind::surface,
                 .object = first_ + static_cast<std::uint32_t>(*touched),
                 .point = out.proxy - poses_[*touched].position,
                 .normal = body.spec.normal,
                 .device = position,
                 .stiffness = stiffness_};
  return out;
}

}  // namespace tactus::sim
