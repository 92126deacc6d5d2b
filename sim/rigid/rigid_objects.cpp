// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/rigid/rigid_objects.h>

#include <algorithm>

namespace tactus::sim {

// ==== rest watch ====

void RestWatch::add(const Pose& pose, double reach) {
  objects_.push_back({.before = pose, .reach = reach, .pile = objects_.size()});
}

std::size_t RestWatch::pile_of(std::size_t object) noexcept {
  while (objects_[object].pile != object) object = objects_[object].pile = objects_[objects_[object].pile].pile;
  return object;
}

void RestWatch::end_period(std::span<const Pose> poses) noexcept {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Watched& object = objects_[i];
    const double moved = norm(poses[i].position - object.before.position) +
                         object.reach * angle_between(object.before.rotation, poses[i].rotation);
    Watched& pile = objects_[pile_of(i)];
    ++pile.members;
    pile.restless = pile.restless || object.disturbed || !(moved < kRestDistance);
    object.before = poses[i];
  }
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const Watched& pile = objects_[pile_of(i)];
    objects_[i].rests = pile.members > 1 && !pile.restless;
  }
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Watched& object = objects_[i];
    object.pile = i;
    object.members = 0;
    object.disturbed = object.restless = false;
  }
}

// ==== rigid objects ====

namespace {

constexpr unsigned kLiftButton = 0;

/// One probe per user. They are copies, so they share the surfaces.
std::vector<RigidProbe> make_probes(const Scene& scene, bool attended) {
  if (scene.users.empty()) return {};
  RigidProbe probe(scene.objects, *scene.touch);
  if (attended) probe.expect_attend();
  return {scene.users.size(), probe};
}

}  // namespace

RigidObjects::RigidObjects(const Scene& scene, const RigidEffort& effort)
    : world_(scene, effort), probes_(make_probes(scene, true)), touches_(scene.users.size()), poses_(scene.objects.size()) {
  if (!sends_loads(scene)) return;
  const std::size_t objects = scene.objects.size() + scene.msds.size(), users = scene.users.size();
  pushes_.resize(objects * users);
  pushing_.resize(objects * users);
  for (std::size_t i = 0; i < objects; ++i)
    loads_.push_back({.external = {}, .hold = {}, .pushes = std::span(pushes_).subspan(i * users, users)});
}

void RigidObjects::observe(TraceFrame& frame) noexcept {
  frame.tick = world_.tick();
  frame.changed->assign(world_.changed().begin(), world_.changed().end());
  for (const std::uint32_t i : world_.changed()) {
    frame.objects[i] = world_.sample(i);
    for (RigidProbe& probe : probes_) probe.attend(i, poses_[i]);
    poses_[i] = frame.objects[i].pose;
  }
}

Touch RigidObjects::touch(std::size_t user, const DeviceSample& device, bool) noexcept {
  return touches_[user] = probes_[user].move(device.position, device.is_down(kLiftButton), poses_);
}

void RigidObjects::push(std::size_t user, double fraction) noexcept {
  const Touch& touch = touches_[user];
  if (touch.contact.kind == ContactKind::none) return;
  const Vec3 force = -(fraction * touch.force);
  world_.push(touch.contact.object, force, touch.proxy);
  if (!loads_.empty()) pushing_[touch.contact.object * touches_.size() + user] = force;
}

void RigidObjects::move_to(std::uint32_t object, const Pose& pose) noexcept {
  world_.move_to(object, pose);
  for (RigidProbe& probe : probes_) probe.attend(object, poses_[object]);
  poses_[object] = pose;
}

tl::expected<void, Diagnostic> RigidObjects::step() {
  TACTUS_CHECK(world_.step());
  if (loads_.empty()) return {};
  for (std::uint32_t i = 0; i < poses_.size(); ++i) {
    const RigidWorld::Load& load = world_.load(i);
    loads_[i].external = load.external;
    loads_[i].hold = load.hold;
  }
  std::ranges::copy(pushing_, pushes_.begin());
  std::ranges::fill(pushing_, Vec3{});
  return {};
}

RigidView::RigidView(const Scene& scene, News news) : news_(news), probes_(make_probes(scene, news == News::of_changed)) {
  for (const SceneObject& object : scene.objects) poses_.push_back(object.pose);
}

void RigidView::show(std::uint32_t object, const Pose& pose) noexcept {
  if (news_ == News::of_changed)
    for (RigidProbe& probe : probes_) probe.attend(object, poses_[object]);
  poses_[object] = pose;
}

Touch RigidView::touch(std::size_t user, const DeviceSample& device, bool) noexcept {
  return probes_[user].move(device.position, device.is_down(kLiftButton), poses_);
}

}  // namespace tactus::sim
