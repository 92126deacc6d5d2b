// SPDX-License-Identifier: Apache-2.0
/// What a RigidWorld consists of. Internal to rigid_world.cpp and rigid_contacts.cpp.
#pragma once

#include <ode/ode.h>

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <tactus/sim/rigid/collision.h>
#include <tactus/sim/rigid/rigid_objects.h>
#include <tactus/sim/rigid/rigid_world.h>

namespace tactus::sim {
namespace rigid {

#ifndef dDOUBLE
#error "ODE must be built with double precision"
#endif

inline constexpr int kMaxContacts = 8;  // per pair; box against box yields up to 8
inline constexpr std::size_t kMostTouching = 65536, kMostPairs = 8 * kMostTouching;
inline constexpr int kMostFound = 4096;              // on a mesh, of which the outermost are kept
inline constexpr double kSliding = 1e-9;             // [m/s] below this a contact point has no direction of sliding
inline constexpr double kStandstill = 1e-8;          // [m/s] an object in contact that is slower stands still
inline constexpr std::uint32_t kFloor = 0xffffffff;  // in place of a body's number

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

inline Vec3 vec(const dReal* v) { return {v[0], v[1], v[2]}; }

inline Quat quaternion(dBodyID body) {
  const dReal* q = dBodyGetQuaternion(body);
  return {q[0], q[1], q[2], q[3]};
}

struct Motion {
  Vec3 velocity, angular_velocity;  // [m/s], [rad/s]
};

/// Of a symmetric matrix.
struct Rows {
  Vec3 x, y, z;
  Vec3 operator*(const Vec3& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
};

struct Body {
  SceneObject spec;
  OdeMesh mesh;              // of spec.surface, if any
  dBodyID handle = nullptr;  // null: static
  dGeomID geom = nullptr;
  double mu = 0;
  Rows inverse_inertia;   // [1/(kg m^2)] about the object's own axes
  Vec3 force, torque;     // of this step [N, N m], world frame
  std::size_t mover = 0;  // its number among those that move
  double reach = 0;       // [m] of its corners from its centre
  bool awake = false;
  bool touches = false;      // in this step
  bool stands = false;       // stood still after the last step
  std::uint32_t still = 0;   // ticks in which no bit of its state changed
  std::uint32_t group = 0;   // another body of its contact group; itself: it represents the group
  std::uint32_t island = 0;  // representative of its group; kFloor: it touches nothing
  RigidSample before;        // this step
  RigidWorld::Load load;     // of it
};

/// Two bodies near each other and their contacts. The first body can move.
struct Pair {
  std::uint32_t a = 0, b = 0;
  std::size_t first = 0, count = 0;  // contacts
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
  std::vector<Body> bodies;
  std::int64_t tick = 0;
  bool tells_loads = false;
  RestWatch watch;
  std::vector<Pose> moving;            // poses for it
  std::vector<std::uint32_t> awake;    // bodies, ascending
  std::vector<std::uint32_t> changed;  // by the last step, ascending
  BoxTree resting;                     // bodies that are static, or slept when it was built
  bool resting_is_old = true;
  // Of one step.
  std::vector<Pair> pairs;
  std::vector<dContact> touching;
  std::vector<dJointFeedback> forces;                   // of them; empty unless loads are told
  std::vector<std::pair<double, std::uint32_t>> order;  // of those awake, along x
  std::vector<std::uint32_t> groups;                    // those awake, group by group
  std::vector<dContact> found;                          // of one pair

  explicit Impl(const Scene& scene);
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void add(const SceneObject& spec);
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
  void step_groups();
  void attach(const Pair& pair);
  void tell_loads();
  void add_hold(const Pair& pair);
  rigid::Motion motion_without_contact(const Body& body) const;
  Vec3 velocity_without_contact(const Body* body, const Vec3& point) const;
  void project(Body& body) const;
  void stand_still(Body& body) const;
  RigidSample sample(const Body& body) const;
  bool ends_period() const noexcept { return tick % kRestTicks == kRestTicks - 1; }
  void let_still_sleep();
  void let_piles_sleep();
  void put_to_sleep(std::uint32_t number);
  void wake(std::uint32_t number);
};

}  // namespace tactus::sim
