// SPDX-License-Identifier: Apache-2.0
// How bodies move in a step, besides what their contacts do to each other (rigid_contacts.cpp).
//
// Leapfrog: velocities as stepped are those of half a step before the tick, positions those of the tick. A motion that begins at a tick
// begins with half a kick, and a push that begins or ends in it counts by half, so that falls, slides and pushes are exact from the
// start.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include <tactus/sim/rigid/rigid_parts.h>

namespace tactus::sim {

using namespace rigid;

namespace {

constexpr double kResting = 1e-3;  // [m/s]
constexpr double kSlow = 1e-3,
                 kSlowSphere = 1;  // [rad/s] ODE's own rotation will do: it is 1e-7 off, and forgets gyroscopic torque

constexpr std::uint8_t kAllTurns = Dof::rx | Dof::ry | Dof::rz;

/// Of a push that begins or ends with this step one half.
Vec3 at_tick(const Vec3& before, const Vec3& now) {
  if (before == Vec3{}) return 0.5 * now;
  return now == Vec3{} ? 0.5 * before : now;
}

bool are_same(const RigidSample& a, const RigidSample& b) {
  using Bits = std::array<std::uint64_t, 13>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

}  // namespace

/// Decide how much of this step's forces acts. A group begins to move as a whole: if one of it moves already, its weight rests on others.
void RigidWorld::Impl::scale_pushes() {
  for (auto first = groups.begin(); first != groups.end();) {
    const std::uint32_t island = bodies[*first].island;
    const auto last = island == kFloor
                          ? first + 1
                          : std::find_if(first, groups.end(), [&](std::uint32_t i) { return bodies[i].island != island; });
    const bool start = std::all_of(first, last, [this](std::uint32_t i) { return bodies[i].starts; });
    const bool calm = std::all_of(first, last, [this](std::uint32_t i) { return bodies[i].push == Push{}; });
    for (; first != last; ++first) {
      Body& body = bodies[*first];
      body.fraction = start ? 0.5 : 1;
      body.calm = calm;
      body.applied = {at_tick(body.pushed.force, body.push.force), at_tick(body.pushed.torque, body.push.torque)};
    }
  }
}

/// Velocities at the end of this step if nothing but gravity and pushes acted.
Motion RigidWorld::Impl::motion_without_contact(const Body& body) const {
  const Quat rotation = quaternion(body.handle);
  const Vec3 torque = rotate(conjugate(rotation), body.applied.torque);
  const auto [v, w] = motion_of(body.handle);
  return {v + h * (body.fraction * gravity + (1 / body.spec.mass) * body.applied.force),
          w + h * rotate(rotation, body.inertia.inverse * torque)};
}

Vec3 RigidWorld::Impl::velocity_without_contact(const Body* body, const Vec3& point) const {
  if (!body || !body->handle) return {};
  const Motion motion = motion_without_contact(*body);
  return motion.velocity + cross(motion.angular_velocity, point - vec(dBodyGetPosition(body->handle)));
}

void RigidWorld::Impl::begin(Body& body) const {
  body.before = sample(body);
  body.stepped = motion_of(body.handle);
  body.free = motion_without_contact(body);
  add_forces(body);
}

void RigidWorld::Impl::add_forces(const Body& body) const {
  const Vec3 force = body.applied.force + (body.fraction * body.spec.mass) * gravity;
  dBodyAddForce(body.handle, force.x, force.y, force.z);
  dBodyAddTorque(body.handle, body.applied.torque.x, body.applied.torque.y, body.applied.torque.z);
}

void RigidWorld::Impl::end(Body& body) {
  turn(body);
  project(body);
  stand_still(body);
  body.starts = body.stands;
  const Motion now = motion_of(body.handle);
  body.change_before = body.change;
  body.change = {(1 / body.fraction) * (now.velocity - body.stepped.velocity),
                 (1 / body.fraction) * (now.angular_velocity - body.stepped.angular_velocity)};
  judge_drift(body);
  judge_flight(body);
}

void RigidWorld::Impl::judge_drift(Body& body) {
  const auto number = static_cast<std::uint32_t>(&body - bodies.data());
  const bool rests = body.touches && body.calm && norm(vec(dBodyGetLinearVel(body.handle))) < kResting;
  const Vec3 x = vec(dBodyGetPosition(body.handle));
  if (!body.rests) body.rests_at = x;
  body.rests = rests;
  if (!rests) return;
  const double drift = norm(x - body.rests_at);
  errors.objects[number].drift = std::max(errors.objects[number].drift, drift);
  errors.drift.add(drift, tick, number);
}

/// [J] at the tick, of a body on which only gravity acts.
double RigidWorld::Impl::energy(const Body& body) const {
  const auto [pose, velocity, angular_velocity] = sample(body);
  const Vec3 v = velocity + (h / 2) * gravity, w = rotate(conjugate(pose.rotation), angular_velocity);
  return body.spec.mass * (dot(v, v) / 2 - dot(gravity, pose.position)) + dot(w, body.inertia.moments * w) / 2;
}

void RigidWorld::Impl::judge_flight(Body& body) {
  const auto number = static_cast<std::uint32_t>(&body - bodies.data());
  if (body.touches || body.applied != Push{} || body.spec.damping != 1 || body.spec.dof != Dof::all) return body.flight.reset();
  const double now = energy(body), change = std::abs(now - body.flight.value_or(now));
  if (!body.flight) body.flight = now;
  errors.objects[number].flight = std::max(errors.objects[number].flight, change);
  errors.flight.add(change, tick, number);
}

/// With the angular momentum that forces left it.
void RigidWorld::Impl::turn(Body& body) const {
  const Vec3 w = vec(dBodyGetAngularVel(body.handle));
  const bool is_slow = norm(w) < (body.inertia.is_spherical ? kSlowSphere : kSlow);
  if ((body.spec.dof & kAllTurns) != kAllTurns || is_slow) return;
  const Turning turned = turn_freely({body.before.pose.rotation, w}, body.inertia, h);
  const dQuaternion rotation{turned.rotation.w, turned.rotation.x, turned.rotation.y, turned.rotation.z};
  dBodySetQuaternion(body.handle, rotation);
  dBodySetAngularVel(body.handle, turned.angular_velocity.x, turned.angular_velocity.y, turned.angular_velocity.z);
}

/// Damp the velocities, then project the object back onto its free axes.
void RigidWorld::Impl::project(Body& body) const {
  const std::uint8_t dof = body.spec.dof;
  const Vec3 v = body.spec.damping * along_free(vec(dBodyGetLinearVel(body.handle)), dof, 0);
  const Vec3 w = body.spec.damping * along_free(vec(dBodyGetAngularVel(body.handle)), dof, 3);
  set_motion(body.handle, {v, w});
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
  const bool is_pushed = body.applied != Push{};
  const double speed = norm(vec(dBodyGetLinearVel(body.handle))) + body.reach * norm(vec(dBodyGetAngularVel(body.handle)));
  body.stands = body.touches && !is_pushed && speed < (body.stands ? 10 : 1) * kStandstill;
  if (body.stands) {
    set_pose(body.handle, body.before.pose);
    set_motion(body.handle, {});
  }
  body.still = !is_pushed && are_same(sample(body), body.before) ? body.still + 1 : 0;
}

}  // namespace tactus::sim
