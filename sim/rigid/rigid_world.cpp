// SPDX-License-Identifier: Apache-2.0
#include "sim/rigid/rigid_world.h"

#include <ode/ode.h>
#include <algorithm>
#include <vector>

#include "sim/rigid/ode_mesh.h"
#include "sim/rigid/rest_watch.h"

namespace tactus {
namespace {

#ifndef dDOUBLE
#error "ODE must be built with double precision"
#endif

// Resting boxes stay this deep in what carries them [m]: at depth 0 rounding would open and close the contact in turn. The floor
// is raised by as much, so that a box on it rests at the height the scene gives.
constexpr double kSurfaceLayer = 1e-5;
// dWorldStep loses friction for single ticks ("LCP internal error" on a pushed cube that sticks). QuickStep does not; for one
// cube on the floor its error in the friction force falls from 3e-2 (20 iterations) over 1e-6 (50) to 1e-8 (100) of mu N.
constexpr int kIterations = 100;
constexpr int kMaxContacts = 8;       // per pair; box against box yields up to 8
constexpr int kMostFound = 4096;      // on a mesh, of which the outermost are kept
constexpr double kStandstill = 1e-9;  // [m/s] below this a contact point has no direction of sliding

// Beyond these a step no longer makes sense, and ODE ends the process when a rotation overflows.
constexpr double kFastest = 1e4;      // [m/s]
constexpr double kFastestTurn = 1e5;  // [rad/s]

/// Keeps ODE initialised for the process and its collision code for this thread.
struct OdeThread {
  OdeThread() {
    struct Library {
      Library() { dInitODE2(0); }
      ~Library() { dCloseODE(); }
    };
    static const Library library;
    dAllocateODEDataForThread(static_cast<unsigned>(dAllocateMaskAll));
  }
};

Vec3 vec(const dReal* v) { return {v[0], v[1], v[2]}; }

Quat quaternion(dBodyID body) {
  const dReal* q = dBodyGetQuaternion(body);
  return {q[0], q[1], q[2], q[3]};
}

/// Components of v along the axes whose bits are set, starting at bit `first`.
Vec3 along_free(const Vec3& v, std::uint8_t dof, int first) {
  return {dof >> first & 1 ? v.x : 0.0, dof >> (first + 1) & 1 ? v.y : 0.0, dof >> (first + 2) & 1 ? v.z : 0.0};
}

struct Motion {
  Vec3 velocity, spin;  // [m/s], [rad/s]
};

/// Neither NaN nor absurd.
bool can_step(const Motion& motion) { return norm(motion.velocity) < kFastest && norm(motion.spin) < kFastestTurn; }

/// Of a symmetric matrix.
struct Rows {
  Vec3 x, y, z;
  Vec3 operator*(const Vec3& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
};

Rows inverse_of(const dMass& mass) {
  const dReal* i = mass.I;
  if (i[1] == 0 && i[2] == 0 && i[6] == 0) return {{1 / i[0], 0, 0}, {0, 1 / i[5], 0}, {0, 0, 1 / i[10]}};
  dMatrix3 inverse{};
  dInvertPDMatrix(mass.I, inverse, 3);
  return {vec(inverse), vec(inverse + 4), vec(inverse + 8)};
}

struct Body {
  SceneObject spec;
  OdeMesh mesh;              // of spec.surface, if any
  dBodyID handle = nullptr;  // null: static
  dGeomID geom = nullptr;
  double mu = 0;
  Rows inverse_inertia;   // [1/(kg m^2)] about the object's own axes
  Vec3 force, torque;     // of this step [N, N m], world frame
  std::size_t mover = 0;  // its number among those that move
};

}  // namespace

struct RigidWorld::Impl {
  OdeThread ode;  // first: the others need it
  dWorldID world = dWorldCreate();
  dSpaceID space = dSimpleSpaceCreate(nullptr);
  dGeomID floor = nullptr;
  dJointGroupID contacts = dJointGroupCreate(0);
  Vec3 gravity;
  std::vector<Body> bodies;
  std::int64_t tick = 0;
  RestWatch watch;
  std::vector<Pose> moving;  // poses for it
  std::size_t sleeping = 0;
  std::vector<dContact> found;  // of one pair

  explicit Impl(const Scene& scene);
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void add(const SceneObject& spec);
  void collide(dGeomID a, dGeomID b);
  Motion motion_without_contact(const Body& body) const;
  Vec3 velocity_without_contact(const Body* body, const Vec3& point) const;
  void project(Body& body) const;
  bool ends_period() const noexcept { return tick % kRestTicks == kRestTicks - 1; }
  void let_sleep();
  void disturb(const Body& body);
  const Body* owner(dGeomID geom) const { return static_cast<const Body*>(dGeomGetData(geom)); }
};

RigidWorld::Impl::Impl(const Scene& scene) : gravity(scene.gravity) {
  dWorldSetGravity(world, gravity.x, gravity.y, gravity.z);
  dWorldSetContactSurfaceLayer(world, kSurfaceLayer);
  dWorldSetQuickStepNumIterations(world, kIterations);
  if (scene.floor) floor = dCreatePlane(space, 0, 0, 1, *scene.floor + kSurfaceLayer);
  bodies.reserve(scene.objects.size());  // geoms and meshes point into it
  for (const SceneObject& object : scene.objects) add(object);
  const bool any_mesh = std::any_of(bodies.begin(), bodies.end(), [](const Body& body) { return body.mesh != nullptr; });
  found.resize(any_mesh ? kMostFound : kMaxContacts);
}

RigidWorld::Impl::~Impl() {
  dJointGroupDestroy(contacts);
  dSpaceDestroy(space);
  dWorldDestroy(world);
}

void RigidWorld::Impl::add(const SceneObject& spec) {
  Body& body = bodies.emplace_back();
  body.spec = spec;
  body.mu = spec.friction;
  if (!spec.surface.triangles.empty()) {
    body.mesh = make_ode_mesh(body.spec.surface);
    body.geom = dCreateTriMesh(space, body.mesh.get(), nullptr, nullptr, nullptr);
  } else {
    body.geom = dCreateBox(space, spec.size.x, spec.size.y, spec.size.z);
  }
  dGeomSetData(body.geom, &body);
  if (spec.dof != Dof::none) {
    dMass mass;
    if (body.mesh) mass = mass_of_mesh(body.geom, spec.mass);
    else dMassSetBoxTotal(&mass, spec.mass, spec.size.x, spec.size.y, spec.size.z);
    body.inverse_inertia = inverse_of(mass);
    body.handle = dBodyCreate(world);
    dBodySetMass(body.handle, &mass);
    body.mover = moving.size();
    moving.push_back(spec.pose);
    double reach = body.mesh ? 0 : norm(spec.size) / 2;
    for (const Vec3& v : spec.surface.vertices) reach = std::max(reach, norm(v));
    watch.add(spec.pose, reach);
    dGeomSetBody(body.geom, body.handle);
  }
  const dQuaternion rotation{spec.pose.rotation.w, spec.pose.rotation.x, spec.pose.rotation.y, spec.pose.rotation.z};
  dGeomSetPosition(body.geom, spec.pose.position.x, spec.pose.position.y, spec.pose.position.z);
  dGeomSetQuaternion(body.geom, rotation);
}

/// Velocities at the end of this step if nothing but gravity and pushes acted.
Motion RigidWorld::Impl::motion_without_contact(const Body& body) const {
  const Quat rotation = quaternion(body.handle);
  const Vec3 torque = rotate(conjugate(rotation), body.torque);
  return {vec(dBodyGetLinearVel(body.handle)) + kTick * (gravity + (1 / body.spec.mass) * body.force),
          vec(dBodyGetAngularVel(body.handle)) + kTick * rotate(rotation, body.inverse_inertia * torque)};
}

Vec3 RigidWorld::Impl::velocity_without_contact(const Body* body, const Vec3& point) const {
  if (!body || !body->handle) return {};
  const Motion motion = motion_without_contact(*body);
  return motion.velocity + cross(motion.spin, point - vec(dBodyGetPosition(body->handle)));
}

void RigidWorld::Impl::collide(dGeomID a, dGeomID b) {
  const Body* first = owner(a);
  const Body* second = owner(b);
  dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
  if (!body_a && !body_b) return;

  const bool on_mesh = dGeomGetClass(a) == dTriMeshClass || dGeomGetClass(b) == dTriMeshClass;
  int count = dCollide(a, b, on_mesh ? kMostFound : kMaxContacts, &found[0].geom, sizeof(dContact));
  if (on_mesh) count = keep_outermost(std::span(found).first(static_cast<std::size_t>(count)), kMaxContacts);
  if (count > 0 && body_a && body_b && ends_period()) watch.touch(first->mover, second->mover);
  for (int i = 0; i < count; ++i) {
    dContact& contact = found[static_cast<std::size_t>(i)];
    contact.surface = {};
    contact.surface.mode = dContactApprox1;
    contact.surface.mu = !first ? second->mu : !second ? first->mu : std::min(first->mu, second->mu);
    const Vec3 point = vec(contact.geom.pos), normal = vec(contact.geom.normal);
    const Vec3 relative = velocity_without_contact(first, point) - velocity_without_contact(second, point);
    const Vec3 sliding = relative - dot(relative, normal) * normal;
    if (const double speed = norm(sliding); speed > kStandstill) {
      contact.surface.mode |= dContactFDir1;
      contact.fdir1[0] = sliding.x / speed;
      contact.fdir1[1] = sliding.y / speed;
      contact.fdir1[2] = sliding.z / speed;
    }
    dJointAttach(dJointCreateContact(world, contacts, &contact), body_a, body_b);
  }
}

/// Damp, then put the object back onto its axes.
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

/// At the end of a period; whatever wakes a body, a push or one that hits it, wakes all that it touches.
void RigidWorld::Impl::let_sleep() {
  for (const Body& body : bodies)
    if (body.handle) moving[body.mover] = {vec(dBodyGetPosition(body.handle)), quaternion(body.handle)};
  watch.end_period(moving);
  sleeping = 0;
  for (const Body& body : bodies) {
    if (!body.handle || !watch.rests(body.mover)) continue;
    dBodySetLinearVel(body.handle, 0, 0, 0);
    dBodySetAngularVel(body.handle, 0, 0, 0);
    dBodyDisable(body.handle);
    ++sleeping;
  }
}

void RigidWorld::Impl::disturb(const Body& body) {
  watch.disturb(body.mover);
  if (dBodyIsEnabled(body.handle)) return;
  dBodyEnable(body.handle);
  --sleeping;
}

RigidWorld::RigidWorld(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}
RigidWorld::RigidWorld(RigidWorld&&) noexcept = default;
RigidWorld& RigidWorld::operator=(RigidWorld&&) noexcept = default;
RigidWorld::~RigidWorld() = default;

void RigidWorld::push(std::uint32_t object, const Vec3& force, const Vec3& point) noexcept {
  Body& body = impl_->bodies[object];
  if (!body.handle) return;
  if (force != Vec3{}) impl_->disturb(body);
  body.force = body.force + force;
  body.torque = body.torque + along_free(cross(point - vec(dBodyGetPosition(body.handle)), force), body.spec.dof, 3);
}

tl::expected<void, StepError> RigidWorld::step() {
  Impl& in = *impl_;
  if (in.sleeping > 0 && in.sleeping == in.moving.size()) {
    ++in.tick;
    return {};
  }
  // QuickStep shuffles its constraints with the process's one random generator; seeded, a step depends on this world alone.
  dRandSetSeed(static_cast<unsigned long>(in.tick));
  const auto broken = [&](std::uint32_t i) {
    return tl::unexpected(StepError{Error{Errc::invalid_argument, "R-SIM-1", 0}, in.tick, i});
  };
  for (std::uint32_t i = 0; i < in.bodies.size(); ++i) {
    const Body& body = in.bodies[i];
    if (!body.handle) continue;
    if (!can_step(in.motion_without_contact(body))) return broken(i);
    dBodyAddForce(body.handle, body.force.x, body.force.y, body.force.z);
    dBodyAddTorque(body.handle, body.torque.x, body.torque.y, body.torque.z);
  }
  dJointGroupEmpty(in.contacts);
  dSpaceCollide(in.space, &in, [](void* self, dGeomID a, dGeomID b) { static_cast<Impl*>(self)->collide(a, b); });
  dWorldQuickStep(in.world, kTick);
  for (std::uint32_t i = 0; i < in.bodies.size(); ++i) {
    Body& body = in.bodies[i];
    body.force = body.torque = {};
    if (!body.handle) continue;
    in.project(body);
    const RigidSample s = sample(i);
    if (!is_finite(s.pose.position) || !is_finite(s.pose.rotation) || !can_step({s.velocity, s.angular_velocity}))
      return broken(i);
  }
  if (in.ends_period()) in.let_sleep();
  ++in.tick;
  return {};
}

RigidSample RigidWorld::sample(std::uint32_t object) const noexcept {
  const Body& body = impl_->bodies[object];
  if (!body.handle) return {.pose = body.spec.pose, .velocity = {}, .angular_velocity = {}};
  return {.pose = {vec(dBodyGetPosition(body.handle)), quaternion(body.handle)},
          .velocity = vec(dBodyGetLinearVel(body.handle)),
          .angular_velocity = vec(dBodyGetAngularVel(body.handle))};
}

std::int64_t RigidWorld::tick() const noexcept { return impl_->tick; }

}  // namespace tactus
