// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/elementary.h>
#include <tactus/sim/rigid/rigid_world.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/sim/rigid/rigid_parts.h>

namespace tactus::sim {
namespace {

using namespace rigid;

constexpr std::uint32_t kStillTicks = 16;

Inertia inertia_of(const dMass& mass) {
  const dReal* i = mass.I;
  const Rows moments{vec(i), vec(i + 4), vec(i + 8)};
  if (i[1] == 0 && i[2] == 0 && i[6] == 0)
    return {.moments = moments,
            .inverse = {{1 / i[0], 0, 0}, {0, 1 / i[5], 0}, {0, 0, 1 / i[10]}},
            .is_spherical = i[0] == i[5] && i[5] == i[10]};
  dMatrix3 inverse{};
  dInvertPDMatrix(mass.I, inverse, 3);
  return {.moments = moments, .inverse = {vec(inverse), vec(inverse + 4), vec(inverse + 8)}};
}

}  // namespace

RigidWorld::Impl::Impl(const Scene& scene, const RigidEffort& effort)
    : gravity(scene.gravity),
      h(kTick / effort.parts),
      parts(effort.parts),
      iterations(effort.iterations),
      sends_loads(sim::sends_loads(scene)) {
  dWorldSetContactSurfaceLayer(world, kSurfaceLayer);
  if (scene.floor) {
    floor_height = *scene.floor + kSurfaceLayer;
    floor = dCreatePlane(nullptr, 0, 0, 1, floor_height);
  }
  bodies.reserve(scene.objects.size());  // meshes point into it
  for (const SceneObject& object : scene.objects) add(object);
  const bool any_mesh = std::any_of(bodies.begin(), bodies.end(), [](const Body& body) { return body.mesh != nullptr; });
  found.resize(any_mesh ? kMostFound : kMaxContacts);
  changed.resize(bodies.size());
  errors.objects.resize(bodies.size());
  std::iota(changed.begin(), changed.end(), 0U);
  for (auto* numbers : {&awake, &groups}) numbers->reserve(moving.size());
  order.reserve(moving.size());
  resting.reserve(bodies.size());
  pairs.reserve(8 * moving.size());
  touching.reserve(moving.size() * 2 * kMaxContacts);
  if (sends_loads) forces.reserve(touching.capacity());
  for (std::uint32_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].handle) awake.push_back(i);
}

RigidWorld::Impl::~Impl() {
  dJointGroupDestroy(contacts);
  for (const Body& body : bodies) dGeomDestroy(body.geom);
  if (floor) dGeomDestroy(floor);
  dWorldDestroy(world);
}

void RigidWorld::Impl::add(const SceneObject& spec) {
  Body& body = bodies.emplace_back();
  body.spec = spec;
  if (parts > 1) body.spec.damping = power(spec.damping, 1.0 / parts);
  body.mu = spec.friction;
  if (!spec.surface.triangles.empty()) {
    body.mesh = make_ode_mesh(body.spec.surface);
    body.geom = dCreateTriMesh(nullptr, body.mesh.get(), nullptr, nullptr, nullptr);
  } else {
    body.geom = dCreateBox(nullptr, spec.size.x, spec.size.y, spec.size.z);
  }
  if (spec.dof != Dof::none) {
    dMass mass;
    if (body.mesh) mass = mass_of_mesh(body.geom, spec.mass);
    else dMassSetBoxTotal(&mass, spec.mass, spec.size.x, spec.size.y, spec.size.z);
    body.inertia = inertia_of(mass);
    body.handle = dBodyCreate(world);
    dBodySetMass(body.handle, &mass);
    dBodySetGravityMode(body.handle, 0);
    dBodySetGyroscopicMode(body.handle, 0);
    set_motion(body.handle, {spec.velocity, spec.angular_velocity});
    body.mover = moving.size();
    moving.push_back(spec.pose);
    body.awake = true;
    body.reach = body.mesh ? 0 : norm(spec.size) / 2;
    for (const Vec3& v : spec.surface.vertices) body.reach = std::max(body.reach, norm(v));
    watch.add(spec.pose, body.reach);
    dGeomSetBody(body.geom, body.handle);
  }
  const dQuaternion rotation{spec.pose.rotation.w, spec.pose.rotation.x, spec.pose.rotation.y, spec.pose.rotation.z};
  dGeomSetPosition(body.geom, spec.pose.position.x, spec.pose.position.y, spec.pose.position.z);
  dGeomSetQuaternion(body.geom, rotation);
}

RigidSample RigidWorld::Impl::sample(const Body& body) const {
  if (!body.handle) return {.pose = body.spec.pose, .velocity = {}, .angular_velocity = {}};
  return {.pose = {vec(dBodyGetPosition(body.handle)), quaternion(body.handle)},
          .velocity = vec(dBodyGetLinearVel(body.handle)),
          .angular_velocity = vec(dBodyGetAngularVel(body.handle))};
}

void RigidWorld::Impl::put_to_sleep(std::uint32_t number) {
  Body& body = bodies[number];
  dBodyDisable(body.handle);
  body.awake = false;
  body.starts = true;
  std::erase(awake, number);
  resting_is_old = true;
}

/// A group of touching objects sleeps as a whole or not at all.
void RigidWorld::Impl::let_still_sleep() {
  for (auto first = groups.begin(); first != groups.end();) {
    const std::uint32_t island = bodies[*first].island;
    const auto is_still = [this](std::uint32_t i) { return bodies[i].still >= kStillTicks; };
    const auto last = island == kFloor
                          ? first + 1
                          : std::find_if(first, groups.end(), [&](std::uint32_t i) { return bodies[i].island != island; });
    if (std::all_of(first, last, is_still)) std::for_each(first, last, [this](std::uint32_t i) { put_to_sleep(i); });
    first = last;
  }
}

/// Put resting piles to sleep at the end of a period. A push or a hit that wakes a body wakes all that it touches.
void RigidWorld::Impl::let_piles_sleep() {
  for (const Body& body : bodies)
    if (body.handle) moving[body.mover] = {vec(dBodyGetPosition(body.handle)), quaternion(body.handle)};
  watch.end_period(moving);
  for (const std::uint32_t i : groups) {
    const Body& body = bodies[i];
    if (!body.awake || !watch.rests(body.mover)) continue;
    set_motion(body.handle, {});
    put_to_sleep(i);
  }
}

void RigidWorld::Impl::wake(std::uint32_t number) {
  Body& body = bodies[number];
  body.still = 0;
  if (body.awake) return;
  body.awake = true;
  dBodyEnable(body.handle);
  awake.insert(std::lower_bound(awake.begin(), awake.end(), number), number);
}

RigidWorld::RigidWorld(const Scene& scene, const RigidEffort& effort) : impl_(std::make_unique<Impl>(scene, effort)) {}
RigidWorld::RigidWorld(RigidWorld&&) noexcept = default;
RigidWorld& RigidWorld::operator=(RigidWorld&&) noexcept = default;
RigidWorld::~RigidWorld() = default;

void RigidWorld::push(std::uint32_t object, const Vec3& force, const Vec3& point) noexcept {
  Body& body = impl_->bodies[object];
  if (!body.handle || force == Vec3{}) return;
  impl_->watch.disturb(body.mover);
  impl_->wake(object);
  body.push.force = body.push.force + force;
  body.push.torque = body.push.torque + along_free(cross(point - vec(dBodyGetPosition(body.handle)), force), body.spec.dof, 3);
}

void RigidWorld::move_to(std::uint32_t object, const Pose& pose) noexcept {
  Body& body = impl_->bodies[object];
  if (!body.handle) return;
  impl_->watch.disturb(body.mover);
  impl_->wake(object);
  const dQuaternion rotation{pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z};
  dBodySetPosition(body.handle, pose.position.x, pose.position.y, pose.position.z);
  dBodySetQuaternion(body.handle, rotation);
}

void RigidWorld::wake(std::uint32_t object) noexcept {
  if (impl_->bodies[object].handle) impl_->wake(object);
}

std::span<const std::uint32_t> RigidWorld::changed() const noexcept { return impl_->changed; }

tl::expected<void, Diagnostic> RigidWorld::step() {
  Impl& in = *impl_;
  in.changed.clear();
  for (in.part = 0; in.part < in.parts && !in.awake.empty(); ++in.part) TACTUS_CHECK(in.step());
  std::ranges::sort(in.changed);
  in.changed.erase(std::unique(in.changed.begin(), in.changed.end()), in.changed.end());
  for (const std::uint32_t i : in.changed) in.bodies[i].push = {};
  ++in.tick;
  return {};
}

tl::expected<void, Diagnostic> RigidWorld::Impl::step() {
  const auto broken = [&](std::uint32_t i) {
    return tl::unexpected(
        Diagnostic{.error = fail(Errc::invalid_argument, "R-SIM-1").value(), .step = tick, .kind = "object", .element = i});
  };
  if (resting_is_old) rebuild_resting();
  find_pairs();
  if (!find_contacts())
    return tl::unexpected(Diagnostic{
        .error = fail(Errc::limit_exceeded, "R-SIM-6").value(), .step = tick, .kind = "object", .element = awake.front()});
  make_groups();
  changed.insert(changed.end(), awake.begin(), awake.end());
  scale_pushes();
  for (const std::uint32_t i : awake) {
    if (!can_step(motion_without_contact(bodies[i]))) return broken(i);
    begin(bodies[i]);
  }
  step_groups();
  for (const std::uint32_t i : awake) end(bodies[i]);
  if (sends_loads) store_loads();
  for (const std::uint32_t i : awake) {
    bodies[i].pushed = bodies[i].push;
    const RigidSample s = sample(bodies[i]);
    if (!is_finite(s.pose.position) || !is_finite(s.pose.rotation) || !can_step({s.velocity, s.angular_velocity}))
      return broken(i);
  }
  let_still_sleep();
  if (ends_period()) let_piles_sleep();
  return {};
}

RigidSample RigidWorld::sample(std::uint32_t object) const noexcept { return impl_->sample(impl_->bodies[object]); }

const RigidWorld::Load& RigidWorld::load(std::uint32_t object) const noexcept { return impl_->bodies[object].load; }

Vec3 RigidWorld::inertia(std::uint32_t object) const noexcept {
  const Body& body = impl_->bodies[object];
  if (body.handle == nullptr) return {};
  return {1 / body.inertia.inverse.x.x, 1 / body.inertia.inverse.y.y, 1 / body.inertia.inverse.z.z};
}

const RigidErrors& RigidWorld::errors() const noexcept { return impl_->errors; }

double RigidWorld::energy(std::uint32_t object) const noexcept {
  const Body& body = impl_->bodies[object];
  if (!body.handle) return 0;
  const RigidSample now = impl_->sample(body);
  const auto [v, w] = body.awake ? motion_at_tick(body) : Motion{};
  const Vec3 turning = rotate(conjugate(now.pose.rotation), w);
  return body.spec.mass * (dot(v, v) / 2 - dot(impl_->gravity, now.pose.position - body.spec.pose.position)) +
         dot(turning, body.inertia.moments * turning) / 2;
}

std::int64_t RigidWorld::tick() const noexcept { return impl_->tick; }

}  // namespace tactus::sim
