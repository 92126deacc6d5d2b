// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/rigid/rigid_world.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>

#include <tactus/base/rule.h>
#include <tactus/sim/rigid/rigid_parts.h>

namespace tactus::sim {
namespace {

using namespace rigid;

// Depth of resting boxes in their support [m]: at depth 0 rounding would open and close the contact in turn. The floor is raised by
// as much, so that a box on it rests at the height the scene gives.
constexpr double kSurfaceLayer = 1e-5;
// dWorldStep loses friction for single ticks ("LCP internal error" on a pushed cube that sticks). QuickStep does not; for one
// cube on the floor its error in the friction force falls from 3e-2 (20 iterations) over 1e-6 (50) to 1e-8 (100) of mu N.
constexpr int kIterations = 100;
constexpr std::uint32_t kStillTicks = 16;

// Faster objects cannot be stepped sensibly, and ODE aborts the process when a rotation overflows.
constexpr double kFastest = 1e4;      // [m/s]
constexpr double kFastestTurn = 1e5;  // [rad/s]

/// Components of v along the axes whose bits are set, starting at bit `first`.
Vec3 along_free(const Vec3& v, std::uint8_t dof, int first) {
  return {dof >> first & 1 ? v.x : 0.0, dof >> (first + 1) & 1 ? v.y : 0.0, dof >> (first + 2) & 1 ? v.z : 0.0};
}

/// Neither NaN nor too fast.
bool can_step(const Motion& motion) { return norm(motion.velocity) < kFastest && norm(motion.angular_velocity) < kFastestTurn; }

Rows inverse_of(const dMass& mass) {
  const dReal* i = mass.I;
  if (i[1] == 0 && i[2] == 0 && i[6] == 0) return {{1 / i[0], 0, 0}, {0, 1 / i[5], 0}, {0, 0, 1 / i[10]}};
  dMatrix3 inverse{};
  dInvertPDMatrix(mass.I, inverse, 3);
  return {vec(inverse), vec(inverse + 4), vec(inverse + 8)};
}

bool are_same(const RigidSample& a, const RigidSample& b) {
  using Bits = std::array<std::uint64_t, 13>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

}  // namespace

RigidWorld::Impl::Impl(const Scene& scene) : gravity(scene.gravity), tells_loads(sim::tells_loads(scene)) {
  dWorldSetGravity(world, gravity.x, gravity.y, gravity.z);
  dWorldSetContactSurfaceLayer(world, kSurfaceLayer);
  dWorldSetQuickStepNumIterations(world, kIterations);
  if (scene.floor) {
    floor_height = *scene.floor + kSurfaceLayer;
    floor = dCreatePlane(nullptr, 0, 0, 1, floor_height);
  }
  bodies.reserve(scene.objects.size());  // meshes point into it
  for (const SceneObject& object : scene.objects) add(object);
  const bool any_mesh = std::any_of(bodies.begin(), bodies.end(), [](const Body& body) { return body.mesh != nullptr; });
  found.resize(any_mesh ? kMostFound : kMaxContacts);
  changed.resize(bodies.size());
  std::iota(changed.begin(), changed.end(), 0U);
  for (auto* numbers : {&awake, &groups}) numbers->reserve(moving.size());
  order.reserve(moving.size());
  resting.reserve(bodies.size());
  pairs.reserve(8 * moving.size());
  touching.reserve(moving.size() * 2 * kMaxContacts);
  if (tells_loads) forces.reserve(touching.capacity());
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
    body.inverse_inertia = inverse_of(mass);
    body.handle = dBodyCreate(world);
    dBodySetMass(body.handle, &mass);
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

/// Velocities at the end of this step if nothing but gravity and pushes acted.
rigid::Motion RigidWorld::Impl::motion_without_contact(const Body& body) const {
  const Quat rotation = quaternion(body.handle);
  const Vec3 torque = rotate(conjugate(rotation), body.torque);
  return {vec(dBodyGetLinearVel(body.handle)) + kTick * (gravity + (1 / body.spec.mass) * body.force),
          vec(dBodyGetAngularVel(body.handle)) + kTick * rotate(rotation, body.inverse_inertia * torque)};
}

Vec3 RigidWorld::Impl::velocity_without_contact(const Body* body, const Vec3& point) const {
  if (!body || !body->handle) return {};
  const Motion motion = motion_without_contact(*body);
  return motion.velocity + cross(motion.angular_velocity, point - vec(dBodyGetPosition(body->handle)));
}

/// Damp the velocities, then project the object back onto its free axes.
void RigidWorld::Impl::project(Body& body) const {
  const std::uint8_t dof = body.spec.dof;
  const Vec3 v = body.spec.damping * along_free(vec(dBodyGetLinearVel(body.handle)), dof, 0);
  const Vec3 w = body.spec.damping * along_free(vec(dBodyGetAngularVel(body.handle)), dof, 3);
  dBodySetLinearVel(body.handle, v.x, v.y, v.z);
  dBodySetAngularVel(body.handle, w.x, w.y, w.z);
  if (dof == Dof::all) return;

  const Vec3& home = body.spec.pose.position;
  const Vec3 x = vec(dBodyGetPosition(body.handle));
  dBodySetPosition(body.handle, dof & Dof::x ? x.x : home.x, dof & Dof::y ? x.y : home.y, dof & Dof::z ? x.z : home.z);
  const unsigned turns = static_cast<unsigned>(dof) >> 3;
  if (turns == 7) return;
  const Quat& start = body.spec.pose.rotation;
  const Quat turned = quaternion(body.handle) * conjugate(start);
  const Vec3 axis = along_free({turned.x, turned.y, turned.z}, dof, 3);
  const double length = std::sqrt(turned.w * turned.w + dot(axis, axis));
  const Quat kept = turns == 0 ? start : Quat{turned.w / length, axis.x / length, axis.y / length, axis.z / length} * start;
  const dQuaternion rotation{kept.w, kept.x, kept.y, kept.z};
  dBodySetQuaternion(body.handle, rotation);
}

/// The solver's residual is not motion. A standing object keeps standing up to a higher speed, so that another order of the
/// constraints does not start it.
void RigidWorld::Impl::stand_still(Body& body) const {
  const bool is_pushed = body.force != Vec3{} || body.torque != Vec3{};
  const double speed = norm(vec(dBodyGetLinearVel(body.handle))) + body.reach * norm(vec(dBodyGetAngularVel(body.handle)));
  body.stands = body.touches && !is_pushed && speed < (body.stands ? 10 : 1) * kStandstill;
  if (body.stands) {
    const auto& [x, q] = body.before.pose;
    const dQuaternion rotation{q.w, q.x, q.y, q.z};
    dBodySetPosition(body.handle, x.x, x.y, x.z);
    dBodySetQuaternion(body.handle, rotation);
    std::copy_n(rotation, 4, const_cast<dReal*>(dBodyGetQuaternion(body.handle)));  // ODE normalised it, which changes bits
    dBodySetLinearVel(body.handle, 0, 0, 0);
    dBodySetAngularVel(body.handle, 0, 0, 0);
  }
  body.still = !is_pushed && are_same(sample(body), body.before) ? body.still + 1 : 0;
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
    dBodySetLinearVel(body.handle, 0, 0, 0);
    dBodySetAngularVel(body.handle, 0, 0, 0);
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

RigidWorld::RigidWorld(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}
RigidWorld::RigidWorld(RigidWorld&&) noexcept = default;
RigidWorld& RigidWorld::operator=(RigidWorld&&) noexcept = default;
RigidWorld::~RigidWorld() = default;

void RigidWorld::push(std::uint32_t object, const Vec3& force, const Vec3& point) noexcept {
  Body& body = impl_->bodies[object];
  if (!body.handle || force == Vec3{}) return;
  impl_->watch.disturb(body.mover);
  impl_->wake(object);
  body.force = body.force + force;
  body.torque = body.torque + along_free(cross(point - vec(dBodyGetPosition(body.handle)), force), body.spec.dof, 3);
}

void RigidWorld::place(std::uint32_t object, const Pose& pose) noexcept {
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
  if (in.awake.empty()) {
    ++in.tick;
    return {};
  }
  const auto broken = [&](std::uint32_t i) {
    return tl::unexpected(
        Diagnostic{.error = fail(Errc::invalid_argument, "R-SIM-1").value(), .step = in.tick, .kind = "object", .element = i});
  };
  for (const std::uint32_t i : in.awake) {
    const Body& body = in.bodies[i];
    if (!can_step(in.motion_without_contact(body))) return broken(i);
    dBodyAddForce(body.handle, body.force.x, body.force.y, body.force.z);
    dBodyAddTorque(body.handle, body.torque.x, body.torque.y, body.torque.z);
  }
  if (in.resting_is_old) in.rebuild_resting();
  in.find_pairs();
  if (!in.find_contacts())
    return tl::unexpected(Diagnostic{
        .error = fail(Errc::limit_exceeded, "R-SIM-6").value(), .step = in.tick, .kind = "object", .element = in.awake.front()});
  in.make_groups();
  in.changed = in.awake;
  for (const std::uint32_t i : in.awake) in.bodies[i].before = in.sample(in.bodies[i]);
  in.step_groups();
  for (const std::uint32_t i : in.awake) {
    Body& body = in.bodies[i];
    in.project(body);
    in.stand_still(body);
  }
  if (in.tells_loads) in.tell_loads();
  for (const std::uint32_t i : in.awake) {
    Body& body = in.bodies[i];
    body.force = body.torque = {};
    const RigidSample s = in.sample(body);
    if (!is_finite(s.pose.position) || !is_finite(s.pose.rotation) || !can_step({s.velocity, s.angular_velocity}))
      return broken(i);
  }
  in.let_still_sleep();
  if (in.ends_period()) in.let_piles_sleep();
  ++in.tick;
  return {};
}

RigidSample RigidWorld::sample(std::uint32_t object) const noexcept { return impl_->sample(impl_->bodies[object]); }

const RigidWorld::Load& RigidWorld::load(std::uint32_t object) const noexcept { return impl_->bodies[object].load; }

Vec3 RigidWorld::inertia(std::uint32_t object) const noexcept {
  const Body& body = impl_->bodies[object];
  if (body.handle == nullptr) return {};
  return {1 / body.inverse_inertia.x.x, 1 / body.inverse_inertia.y.y, 1 / body.inverse_inertia.z.z};
}

std::int64_t RigidWorld::tick() const noexcept { return impl_->tick; }

}  // namespace tactus::sim
