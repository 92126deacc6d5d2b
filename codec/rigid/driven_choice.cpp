// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/driven_choice.h>

#include <algorithm>
#include <cmath>

#include <tactus/signal/device_path.h>

namespace tactus {
namespace {

constexpr double kSlowest = 1e-4;  // [m/s]: a slower object has no direction that would last

Vec3i on_grid(const Vec3& v, int exponent) noexcept {
  const auto units = [exponent](double c) {
    return static_cast<std::int32_t>(std::lround(std::clamp(std::ldexp(c, exponent), -1048576.0, 1048576.0)));
  };
  return {units(v.x), units(v.y), units(v.z)};
}

Vec3 off_grid(const Vec3i& v, int exponent) noexcept {
  return std::ldexp(1.0, -exponent) * Vec3{static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

Vec3 inertia_of(const DrivenConstants::Body& body) noexcept {
  return {std::ldexp(body.inertia[0], -30), std::ldexp(body.inertia[1], -30), std::ldexp(body.inertia[2], -30)};
}

Vec3 times(const Vec3& a, const Vec3& b) noexcept { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

}  // namespace

DrivenChoice::DrivenChoice(const Scene& scene, const DevicePath& path)
    : scene_(scene), path_(path), moments_((kWindow + 1) * scene.objects.size()) {
  if (scene.motion) gravity_ = off_grid(scene.motion->gravity, static_cast<int>(scene.grid.velocity));
}

/// The contact whose device is where the path is; null: there is none.
const Contact* DrivenChoice::own_contact(std::uint32_t object, std::span<const Contact> contacts,
                                         const Vec3i& device) const noexcept {
  const auto exponent = static_cast<int>(scene_.grid.position);
  const Vec3 at = off_grid(device, exponent);
  for (const Contact& contact : contacts)
    if (contact.kind != ContactKind::none && contact.object == object && norm(contact.device - at) <= std::ldexp(2.0, -exponent))
      return &contact;
  return nullptr;
}

/// Deceleration along the screw that neither the device nor gravity explains [m/s^2].
/// pre  the moments of the window are there.   in  rounding  what the pull of a receiver has over the true one [m/s^2], world frame
double DrivenChoice::drag_of(std::uint32_t object, const RigidSample& now, const Vec3& rounding) const noexcept {
  const std::span<const Moment> moments = std::span(moments_).subspan((kWindow + 1) * object, kWindow + 1);
  const auto [first, last] = std::ranges::minmax_element(moments, {}, &Moment::tick);
  const Vec3 inertia = inertia_of(scene_.driven->bodies[object]);
  const double speed = std::sqrt(dot(last->velocity, last->velocity) + dot(times(inertia, last->angular), last->angular));
  if (speed < kSlowest) return 0;
  const auto along = [&now](const Vec3& pull, const Vec3& arm) {
    return dot(pull, now.velocity + cross(now.angular_velocity, arm));
  };
  double drive = along(rounding, last->arm);
  for (const Moment& moment : moments) {
    if (&moment == &*last) continue;
    drive += along(moment.pull, moment.arm) / kWindow;
  }
  const double gained =
      dot(last->velocity - first->velocity, last->velocity) + dot(times(inertia, last->angular - first->angular), last->angular);
  const double rate = static_cast<double>(scene_.tick_rate);
  const double damping = std::ldexp(scene_.driven->bodies[object].damping, -20) * rate * speed;
  return (drive + dot(gravity_, now.velocity) - gained * rate / kWindow) / speed - damping;
}

void DrivenChoice::read(std::int64_t tick, std::span<const RigidSample> samples, std::span<const Contact> contacts,
                        std::span<RigidState> truth) noexcept {
  const auto device = path_.at(tick);
  for (const std::uint32_t i : scene_.moving()) {
    truth[i].contact = {};
    const DrivenConstants::Body& body = scene_.driven->bodies[i];
    const Contact* const contact = device && body.coupling != 0 ? own_contact(i, contacts, *device) : nullptr;
    Moment& moment = moments_[(kWindow + 1) * i + static_cast<std::size_t>(tick) % (kWindow + 1)];
    moment.tick = -1;
    if (contact == nullptr || (contact->kind == ContactKind::spring && body.hold == 0)) continue;
    const RigidSample& sample = samples[i];
    const Vec3 gap = contact->device - to_world(sample.pose, contact->point);
    moment = {.tick = tick,
              .velocity = sample.velocity,
              .angular = rotate(conjugate(sample.pose.rotation), sample.angular_velocity),
              .pull = std::ldexp(body.coupling, -8) * gap,
              .arm = rotate(sample.pose.rotation, contact->point)};
    DrivenContact told{.is_held = contact->kind == ContactKind::spring, .point = on_grid(contact->point, DrivenContact::kPoint)};
    if (!told.is_held) {
      const auto window = std::span(moments_).subspan((kWindow + 1) * i, kWindow + 1);
      const std::int64_t first = std::max<std::int64_t>(0, tick - static_cast<std::int64_t>(kWindow));
      const bool whole = std::ranges::all_of(window, [first](const Moment& m) { return m.tick >= first; });
      if (!whole) continue;
      told.normal = on_grid(contact->normal, DrivenContact::kNormal);
      const Vec3 off = contact->point - off_grid(told.point, DrivenContact::kPoint);
      const Vec3 rounding = std::ldexp(body.coupling, -8) * rotate(sample.pose.rotation, off);
      told.drag = on_grid({drag_of(i, sample, rounding), 0, 0}, DrivenContact::kDrag)[0];
    }
    truth[i].contact = told;
  }
}

}  // namespace tactus
