// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/declared_contact.h>

#include <algorithm>
#include <cmath>

#include <tactus/base/rule.h>

namespace tactus {

Contact contact_of_force(const Pose& pose, const Vec3& device, const Vec3& force, double stiffness, ContactKind kind,
                         std::uint32_t object) noexcept {
  const double size = norm(force);
  if (!(size > 0) || kind == ContactKind::none) return {};
  const Quat back = conjugate(pose.rotation);
  return {.kind = kind,
          .object = object,
          .point = rotate(back, device + (1 / stiffness) * force - pose.position),
          .normal = kind == ContactKind::surface ? rotate(back, (1 / size) * force) : Vec3{0, 0, 1},
          .device = device,
          .stiffness = stiffness};
}

Result<ContactDeclarations> ContactDeclarations::create(const TraceInfo& info, std::span<const DeclaredContact> declared) {
  ContactDeclarations out;
  for (const DeclaredContact& of : declared) {
    const auto user = std::ranges::find(info.users, of.user, &TraceUser::name);
    const auto object = std::ranges::find(info.objects, of.object, &TraceObject::name);
    if (user == info.users.end() || object == info.objects.end()) return fail(Errc::invalid_argument, "R-API-5");
    if (!(of.stiffness > 0 && std::isfinite(of.stiffness))) return fail(Errc::invalid_argument, "R-API-4");
    const auto index = static_cast<std::uint32_t>(user - info.users.begin());
    if (std::ranges::find(out.declared_, index, &Declared::user) != out.declared_.end())
      return fail(Errc::invalid_argument, "R-API-5");
    out.declared_.push_back({index, static_cast<std::uint32_t>(object - info.objects.begin()),
                             user->forces != RecordedForces::rendered, of.stiffness, of.kind, of.at});
  }
  return out;
}

void ContactDeclarations::apply(TraceFrame& frame) const noexcept {
  for (const Declared& of : declared_) {
    UserSample& user = frame.users[of.user];
    if (user.contact.kind != ContactKind::none) continue;
    const Pose& pose = frame.objects[of.object].pose;
    if (of.at == ForcePoint::origin) user.device.position = user.contact.device = pose.position;
    const Vec3& force = of.is_of_server ? user.server_force : user.force;
    user.contact = contact_of_force(pose, user.device.position, force, of.stiffness, of.kind, of.object);
  }
}

}  // namespace tactus
