// SPDX-License-Identifier: Apache-2.0
#include "sim/rigid/rigid_world.h"

#include <ode/ode.h>
#include <algorithm>
#include <array>
#include <vector>

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

struct Box {
  SceneObject spec;
  dBodyID body = nullptr;  // null: static
  dGeomID geom = nullptr;
  double mu = 0;
  Vec3 inverse_inertia;   // [1/(kg m^2)] about the box's own axes
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
  std::vector<Box> boxes;
  std::int64_t tick = 0;
  RestWatch watch;
  std::vector<Pose> moving;  // poses for it
  std::size_t sleeping = 0;

  explicit Impl(const Scene& scene);
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void add(const SceneObject& spec);
  void collide(dGeomID a, dGeomID b);
  Motion motion_without_contact(const Box& box) const;
  Vec3 velocity_without_contact(const Box* box, const Vec3& point) const;
  void project(Box& box) const;
  bool ends_period() const noexcept { return tick % kRestTicks == kRestTicks - 1; }
  void let_sleep();
  void disturb(const Box& box);
  const Box* owner(dGeomID geom) const { return static_cast<const Box*>(dGeomGetData(geom)); }
};

RigidWorld::Impl::Impl(const Scene& scene) : gravity(scene.gravity) {
  dWorldSetGravity(world, gravity.x, gravity.y, gravity.z);
  dWorldSetContactSurfaceLayer(world, kSurfaceLayer);
  dWorldSetQuickStepNumIterations(world, kIterations);
  if (scene.floor) floor = dCreatePlane(space, 0, 0, 1, *scene.floor + kSurfaceLayer);
  boxes.reserve(scene.objects.size());  // geoms point into it
  for (const SceneObject& object : scene.objects) add(object);
}

RigidWorld::Impl::~Impl() {
  dJointGroupDestroy(contacts);
  dSpaceDestroy(space);
  dWorldDestroy(world);
}

void RigidWorld::Impl::add(const SceneObject& spec) {
  Box& box = boxes.emplace_back();
  box.spec = spec;
  box.mu = spec.friction;
  box.geom = dCreateBox(space, spec.size.x, spec.size.y, spec.size.z);
  dGeomSetData(box.geom, &box);
  if (spec.dof != Dof::none) {
    dMass mass;
    dMassSetBoxTotal(&mass, spec.mass, spec.size.x, spec.size.y, spec.size.z);
    box.inverse_inertia = {1 / mass.I[0], 1 / mass.I[5], 1 / mass.I[10]};
    box.body = dBodyCreate(world);
    dBodySetMass(box.body, &mass);
    box.mover = moving.size();
    moving.push_back(spec.pose);
    watch.add(spec.pose, norm(spec.size) / 2);
    dGeomSetBody(box.geom, box.body);
  }
  const dQuaternion rotation{spec.pose.rotation.w, spec.pose.rotation.x, spec.pose.rotation.y, spec.pose.rotation.z};
  dGeomSetPosition(box.geom, spec.pose.position.x, spec.pose.position.y, spec.pose.position.z);
  dGeomSetQuaternion(box.geom, rotation);
}

/// Velocities at the end of this step if nothing but gravity and pushes acted.
Motion RigidWorld::Impl::motion_without_contact(const Box& box) const {
  const Quat rotation = quaternion(box.body);
  const Vec3 torque = rotate(conjugate(rotation), box.torque);
  const Vec3& i = box.inverse_inertia;
  return {vec(dBodyGetLinearVel(box.body)) + kTick * (gravity + (1 / box.spec.mass) * box.force),
          vec(dBodyGetAngularVel(box.body)) + kTick * rotate(rotation, {i.x * torque.x, i.y * torque.y, i.z * torque.z})};
}

Vec3 RigidWorld::Impl::velocity_without_contact(const Box* box, const Vec3& point) const {
  if (!box || !box->body) return {};
  const Motion motion = motion_without_contact(*box);
  return motion.velocity + cross(motion.spin, point - vec(dBodyGetPosition(box->body)));
}

void RigidWorld::Impl::collide(dGeomID a, dGeomID b) {
  const Box* first = owner(a);
  const Box* second = owner(b);
  dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
  if (!body_a && !body_b) return;

  std::array<dContact, kMaxContacts> found{};
  const int count = dCollide(a, b, kMaxContacts, &found[0].geom, sizeof(dContact));
  if (count > 0 && body_a && body_b && ends_period()) watch.touch(first->mover, second->mover);
  for (int i = 0; i < count; ++i) {
    dContact& contact = found[static_cast<std::size_t>(i)];
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
void RigidWorld::Impl::project(Box& box) const {
  const std::uint8_t dof = box.spec.dof;
  const Vec3 v = box.spec.damping * along_free(vec(dBodyGetLinearVel(box.body)), dof, 0);
  const Vec3 w = box.spec.damping * along_free(vec(dBodyGetAngularVel(box.body)), dof, 3);
  dBodySetLinearVel(box.body, v.x, v.y, v.z);
  dBodySetAngularVel(box.body, w.x, w.y, w.z);
  if (dof == Dof::all) return;

  const Vec3& home = box.spec.pose.position;
  const Vec3 x = vec(dBodyGetPosition(box.body));
  dBodySetPosition(box.body, dof & Dof::x ? x.x : home.x, dof & Dof::y ? x.y : home.y, dof & Dof::z ? x.z : home.z);
  const unsigned turns = static_cast<unsigned>(dof) >> 3;
  if (turns == 7) return;
  const Quat& start = box.spec.pose.rotation;
  const Quat turned = quaternion(box.body) * conjugate(start);
  const Vec3 axis = along_free({turned.x, turned.y, turned.z}, dof, 3);
  const double length = std::sqrt(turned.w * turned.w + dot(axis, axis));
  const Quat kept = turns == 0 ? start : Quat{turned.w / length, axis.x / length, axis.y / length, axis.z / length} * start;
  const dQuaternion rotation{kept.w, kept.x, kept.y, kept.z};
  dBodySetQuaternion(box.body, rotation);
}

/// At the end of a period; whatever wakes a body, a push or one that hits it, wakes all that it touches.
void RigidWorld::Impl::let_sleep() {
  for (const Box& box : boxes)
    if (box.body) moving[box.mover] = {vec(dBodyGetPosition(box.body)), quaternion(box.body)};
  watch.end_period(moving);
  sleeping = 0;
  for (const Box& box : boxes) {
    if (!box.body || !watch.rests(box.mover)) continue;
    dBodySetLinearVel(box.body, 0, 0, 0);
    dBodySetAngularVel(box.body, 0, 0, 0);
    dBodyDisable(box.body);
    ++sleeping;
  }
}

void RigidWorld::Impl::disturb(const Box& box) {
  watch.disturb(box.mover);
  if (dBodyIsEnabled(box.body)) return;
  dBodyEnable(box.body);
  --sleeping;
}

RigidWorld::RigidWorld(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}
RigidWorld::RigidWorld(RigidWorld&&) noexcept = default;
RigidWorld& RigidWorld::operator=(RigidWorld&&) noexcept = default;
RigidWorld::~RigidWorld() = default;

void RigidWorld::push(std::uint32_t object, const Vec3& force, const Vec3& point) noexcept {
  Box& box = impl_->boxes[object];
  if (!box.body) return;
  if (force != Vec3{}) impl_->disturb(box);
  box.force = box.force + force;
  box.torque = box.torque + along_free(cross(point - vec(dBodyGetPosition(box.body)), force), box.spec.dof, 3);
}

tl::expected<void, StepError> RigidWorld::step() {
  Impl& in = *impl_;
  if (in.sleeping > 0 && in.sleeping == in.moving.size()) {
    ++in.tick;
    return {};
  }
  // QuickStep shuffles its constraints with the process's one random generator; seeded, a step depends on this world alone.
  dRandSetSeed(static_cast<unsigned long>(in.tick));
  const auto broken = [&](std::uint32_t i) { return tl::unexpected(StepError{Error{Errc::internal, "R-SIM-1", 0}, in.tick, i}); };
  for (std::uint32_t i = 0; i < in.boxes.size(); ++i) {
    const Box& box = in.boxes[i];
    if (!box.body) continue;
    if (!can_step(in.motion_without_contact(box))) return broken(i);
    dBodyAddForce(box.body, box.force.x, box.force.y, box.force.z);
    dBodyAddTorque(box.body, box.torque.x, box.torque.y, box.torque.z);
  }
  dJointGroupEmpty(in.contacts);
  dSpaceCollide(in.space, &in, [](void* self, dGeomID a, dGeomID b) { static_cast<Impl*>(self)->collide(a, b); });
  dWorldQuickStep(in.world, kTick);
  for (std::uint32_t i = 0; i < in.boxes.size(); ++i) {
    Box& box = in.boxes[i];
    box.force = box.torque = {};
    if (!box.body) continue;
    in.project(box);
    const RigidSample s = sample(i);
    if (!is_finite(s.pose.position) || !is_finite(s.pose.rotation) || !can_step({s.velocity, s.angular_velocity}))
      return broken(i);
  }
  if (in.ends_period()) in.let_sleep();
  ++in.tick;
  return {};
}

RigidSample RigidWorld::sample(std::uint32_t object) const noexcept {
  const Box& box = impl_->boxes[object];
  if (!box.body) return {.pose = box.spec.pose, .velocity = {}, .angular_velocity = {}};
  return {.pose = {vec(dBodyGetPosition(box.body)), quaternion(box.body)},
          .velocity = vec(dBodyGetLinearVel(box.body)),
          .angular_velocity = vec(dBodyGetAngularVel(box.body))};
}

std::int64_t RigidWorld::tick() const noexcept { return impl_->tick; }

}  // namespace tactus
