// SPDX-License-Identifier: Apache-2.0
/// What a RigidWorld consists of. Internal to rigid_*.cpp.
#pragma once

#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tactus/sim/rigid/collision.h>
#include <tactus/sim/rigid/free_rotation.h>
#include <tactus/sim/rigid/rigid_errors.h>
#include <tactus/sim/rigid/rigid_objects.h>
#include <tactus/sim/rigid/rigid_world.h>

namespace tactus::sim {
namespace rigid {

#ifndef dDOUBLE
#error "ODE must be built with double precision"
#endif

inline constexpr int kMaxContacts = 8;  // per pair; box against box yields up to 8
inline constexpr std::size_t kMostTouching = 65536, kMostPairs = 8 * kMostTouching;
// Depth of resting boxes in their support [m]: at depth 0 rounding would open and close the contact in turn. The floor is raised by
// as much, so that a box on it rests at the height the scene gives.
inline constexpr double kSurfaceLayer = 1e-5;
inline constexpr int kMostFound = 4096;      // on a mesh, of which the outermost are kept
inline constexpr double kSolved = 2e-3;      // [m/s] that may be left at contacts
inline constexpr double kSliding = 1e-9;     // [m/s] below this a contact point has no direction of sliding
inline constexpr double kStandstill = 1e-8;  // [m/s] an object in contact that is slower stands still
// Faster objects cannot be stepped sensibly, and ODE aborts the process when a rotation overflows.
inline constexpr double kFastest = 1e4, kFastestTurn = 1e5;  // [m/s], [rad/s]
inline constexpr std::uint32_t kFloor = 0xffffffff;          // in place of a body's number

/// Its messages are about single attempts of the direct solver, and would go to the standard error. How good each attempt is, is measured.
inline void ignore_message(int, const char*, va_list) {}

/// Keeps ODE initialised for the process and its collision code for this thread.
struct OdeThread {
  OdeThread() {
    struct Library {
      Library() {
        dInitODE2(0);
        if (dGetMessageHandler() == nullptr) dSetMessageHandler(ignore_message);
      }
      ~Library() { dCloseODE(); }
    };
    static const Library library;
    dAllocateODEDataForThread(static_cast<unsigned>(dAllocateMaskAll));
  }
};

inline Vec3 vec(const dReal* v) { return {v[0], v[1], v[2]}; }

inline Quat quaternion(dBodyID body) {
  const dReal* q = dBodyGetQuaternion(body);
  return {q[0], q[1], q[2], q[3]};
}

struct Motion {
  Vec3 velocity, angular_velocity;  // [m/s], [rad/s]
};

/// Neither NaN nor too fast.
inline bool can_step(const Motion& motion) {
  return norm(motion.velocity) < kFastest && norm(motion.angular_velocity) < kFastestTurn;
}

inline void set_pose(dBodyID body, const Pose& pose) {
  const auto& [x, q] = pose;
  const dQuaternion rotation{q.w, q.x, q.y, q.z};
  dBodySetPosition(body, x.x, x.y, x.z);
  dBodySetQuaternion(body, rotation);
  std::copy_n(rotation, 4, const_cast<dReal*>(dBodyGetQuaternion(body)));  // ODE normalised it, which changes bits
}

inline void set_motion(dBodyID body, const Motion& motion) {
  const auto& [v, w] = motion;
  dBodySetLinearVel(body, v.x, v.y, v.z);
  dBodySetAngularVel(body, w.x, w.y, w.z);
}

inline Motion motion_of(dBodyID body) { return {vec(dBodyGetLinearVel(body)), vec(dBodyGetAngularVel(body))}; }

/// Components of v along the axes whose bits are set, starting at bit `first`.
inline Vec3 along_free(const Vec3& v, std::uint8_t dof, int first) {
  return {dof >> first & 1 ? v.x : 0.0, dof >> (first + 1) & 1 ? v.y : 0.0, dof >> (first + 2) & 1 ? v.z : 0.0};
}

/// What users do to a body, in the world frame.
struct Push {
  Vec3 force, torque;  // [N], [N m]
  friend bool operator==(const Push&, const Push&) = default;
};

struct Body {
  SceneObject spec;
  OdeMesh mesh;              // of spec.surface, if any
  dBodyID handle = nullptr;  // null: static
  dGeomID geom = nullptr;
  double mu = 0;
  Inertia inertia;
  Push push, pushed;      // of this step, and of the one before
  Push applied;           // of this step, with half of what begins or ends
  double fraction = 1;    // of the step in which forces act: half of it in the first of a motion
  std::size_t mover = 0;  // its number among those that move
  double reach = 0;       // [m] of its corners from its centre
  bool awake = false;
  bool touches = false;          // in this step
  bool starts = true;            // it was at rest, or it is its first step
  bool stands = false;           // stood still after the last step
  std::uint32_t still = 0;       // ticks in which no bit of its state changed
  std::uint32_t group = 0;       // another body of its contact group; itself: it represents the group
  std::uint32_t island = 0;      // representative of its group; kFloor: it touches nothing
  RigidSample before;            // this step
  Motion stepped, free;          // velocities before it, as stepped, and after it if nothing touched the body
  Motion change, change_before;  // what the last step and the one before it made of them, as if all forces had acted
  Vec3 swept_from;               // [m] where it is, while it is looked for elsewhere
  Pose kept_pose;                // after an attempt to step it
  Motion kept_motion;
  Vec3 rests_at;  // [m] since when it is slow and unpushed
  bool rests = false;
  bool calm = true;              // nobody pushes it, or what it touches
  std::optional<double> flight;  // [J] energy since when it touches nothing
  RigidWorld::Load load;         // of it
};

/// Velocities at the tick: on by half a step from those of half a step before, but not through an impact.
inline Motion motion_at_tick(const Body& body) {
  const auto lesser = [](double a, double b) { return a * b <= 0 ? 0 : std::abs(a) < std::abs(b) ? a : b; };
  const auto at_tick = [&](const Vec3& now, const Vec3& last, const Vec3& before) {
    if (body.fraction < 1) return now + 0.5 * last;  // nothing was before
    return now + 0.5 * Vec3{lesser(last.x, before.x), lesser(last.y, before.y), lesser(last.z, before.z)};
  };
  const auto [v, w] = motion_of(body.handle);
  return {at_tick(v, body.change.velocity, body.change_before.velocity),
          at_tick(w, body.change.angular_velocity, body.change_before.angular_velocity)};
}

/// Two bodies near each other and their contacts. The first body can move.
struct Pair {
  std::uint32_t a = 0, b = 0;
  std::size_t first = 0, count = 0;  // contacts
};

/// Bodies that touch each other, or nothing.
struct Group {
  std::span<const std::uint32_t> members;
  std::span<const Pair> pairs;
};

/// What a step of a group left unsolved.
struct Residual {
  double speed = 0;          // [m/s] of approach at a contact,
  std::uint32_t object = 0;  // of this body
  double created = 0;        // [J] of kinetic energy that contacts gave
  double excess = 0;         // [m/s] as a speed of the whole group, what is more than pushing out explains
  bool is_solution() const { return speed < kSolved && excess < kSolved; }
  double badness() const { return std::max(speed, excess); }
};

}  // namespace rigid

struct RigidWorld::Impl {
  using Body = rigid::Body;
  using Pair = rigid::Pair;

  rigid::OdeThread ode;  // first: the others need it
  dWorldID world = dWorldCreate();
  dGeomID floor = nullptr;
  double floor_height = 0;
  dJointGroupID contacts = dJointGroupCreate(0);
  Vec3 gravity;
  double h;  // [s] of a step
  int parts, iterations, part = 0;
  std::vector<Body> bodies;
  std::int64_t tick = 0;
  bool sends_loads = false;
  RestWatch watch;
  std::vector<Pose> moving;            // poses for it
  std::vector<std::uint32_t> awake;    // bodies, ascending
  std::vector<std::uint32_t> changed;  // by the last step, ascending
  BoxTree resting;                     // bodies that are static, or slept when it was built
  bool resting_is_old = true;
  // Of one step.
  std::vector<Pair> pairs;
  std::vector<dContact> touching;
  std::vector<dJointFeedback> forces;                   // of them; empty unless loads are sent
  std::vector<std::pair<double, std::uint32_t>> order;  // of those awake, along x
  std::vector<std::uint32_t> groups;                    // those awake, group by group
  std::vector<dContact> found;                          // of one pair
  std::vector<dJointFeedback> kept_forces;              // of an attempt
  RigidErrors errors;

  Impl(const Scene& scene, const RigidEffort& effort);
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void add(const SceneObject& spec);
  tl::expected<void, Diagnostic> step();
  dGeomID geom(std::uint32_t body) const { return body == rigid::kFloor ? floor : bodies[body].geom; }
  const Body* body(std::uint32_t number) const { return number == rigid::kFloor ? nullptr : &bodies[number]; }
  Extent bounds(std::uint32_t body) const;
  void rebuild_resting();
  int collide(dGeomID a, dGeomID b);
  void find_pairs();
  void find_pairs_among_awake();
  bool find_contacts();
  std::uint32_t group_of(std::uint32_t body);
  void make_groups();
  Vec3 displacement(std::uint32_t body) const;
  int collide_at(const Pair& pair, double fraction);
  int sweep(const Pair& pair);
  double smallest(std::uint32_t body) const;

  // Solver (rigid_solver.cpp)
  void step_groups();
  void attach(const Pair& pair);
  void solve(const rigid::Group& group);
  void attempt(int most) const;
  void put_back(const rigid::Group& group) const;
  void keep(const rigid::Group& group);
  void restore(const rigid::Group& group);
  rigid::Residual again(const rigid::Group& group, const rigid::Residual& left, int most);
  rigid::Residual solve_directly(const rigid::Group& group, rigid::Residual left);
  double out_at(const dContact& contact) const;
  double left_at(const Pair& pair, const dContact& contact) const;
  rigid::Residual residual(const rigid::Group& group) const;
  void judge(const rigid::Group& group, const rigid::Residual& left);
  void judge_momentum(const rigid::Group& group);
  void store_loads();
  void add_hold(const Pair& pair);
  // Motion (rigid_motion.cpp)
  void scale_pushes();
  rigid::Motion motion_without_contact(const Body& body) const;
  Vec3 velocity_without_contact(const Body* body, const Vec3& point) const;
  void begin(Body& body) const;
  void add_forces(const Body& body) const;
  void end(Body& body);
  void judge_drift(Body& body);
  void judge_flight(Body& body);
  double energy(const Body& body) const;
  void turn(Body& body) const;
  void project(Body& body) const;
  void stand_still(Body& body) const;
  RigidSample sample(const Body& body) const;
  bool ends_period() const noexcept { return part == parts - 1 && tick % kRestTicks == kRestTicks - 1; }
  void let_still_sleep();
  void let_piles_sleep();
  void put_to_sleep(std::uint32_t number);
  void wake(std::uint32_t number);
};

}  // namespace tactus::sim
