// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/compensation.h>

#include <utility>

#include <tactus/load/load_state.h>

namespace tactus::sim {

Vec3 others_push(std::span<const GridForce> load, std::size_t user, unsigned force_exp) noexcept {
  Vec3 sum;
  for (std::size_t v = kPushes; v < load.size(); ++v)
    if (v != kPushes + user) sum = sum + to_force(load[v], force_exp);
  return sum;
}

Result<Compensation> Compensation::create(const Scene& scene) {
  Compensation out(scene);
  for (std::size_t i = 0; i < scene.users.size(); ++i) {
    TACTUS_TRY(auto reduction, StiffnessReduction::create({.filter = scene.compensation->filter}));
    out.reductions_.push_back(std::move(reduction));
  }
  return out;
}

/// [N/m] For the spring between proxy and device.   pre  something is touched
double Compensation::reduced(std::size_t user, const Touch& touch, const Vec3& stretch, const Shown& shown,
                             std::uint32_t delay) noexcept {
  StiffnessReduction& reduction = reductions_[user];
  if (touch.surface) {
    const SurfaceContact& at = *touch.surface;
    if (shown.deformable == nullptr) return at.stiffness;
    const double yields = stiffness_at(*shown.deformable, at.triangle, at.weights);
    return reduction.reduced(StiffnessReduction::DeformableTouch{stretch, at.normal, at.stiffness, yields}, delay);
  }
  const Contact& contact = touch.contact;
  const Vec3 normal = rotate(shown.pose.rotation, contact.normal);
  if (const std::size_t rigid = scene_->objects.size(); contact.object >= rigid) {
    const double yields = scene_->msds[contact.object - rigid].object.stiffness;
    return reduction.reduced(StiffnessReduction::DeformableTouch{stretch, normal, contact.stiffness, yields}, delay);
  }
  if (shown.load.empty()) return contact.stiffness;
  const auto force = [&](std::size_t vector) { return to_force(shown.load[vector], shown.force_exp); };
  return reduction.reduced(StiffnessReduction::RigidTouch{.stretch = stretch,
                                                          .normal = normal,
                                                          .coupling = contact.stiffness,
                                                          .moves = shown.moves,
                                                          .external = force(kExternal),
                                                          .others = others_push(shown.load, user, shown.force_exp),
                                                          .hold = force(kHold)},
                           delay);
}

Vec3 Compensation::soften(std::size_t user, const Touch& touch, const Vec3& device, const Shown& shown,
                          std::uint32_t delay) noexcept {
  const Vec3 stretch = device - (touch.surface ? touch.surface->proxy : touch.proxy);
  const double coupling = touch.surface ? touch.surface->stiffness : touch.contact.stiffness;
  stiffness_[user] = reduced(user, touch, stretch, shown, delay);
  return touch.force + (coupling - stiffness_[user]) * stretch;
}

}  // namespace tactus::sim
