// SPDX-License-Identifier: Apache-2.0
// The steps of groups of touching bodies, and whether what the solver found is a solution.
//
// QuickStep iterates a fixed number of times. That solves most contacts; it does not where a heavy body lies on a light one, or in a
// high stack. What it leaves is measured after each step: the speed at which bodies still approach at their contacts, and kinetic energy
// that no force put in. If either is too large, the step is done again: a small group with ODE's direct solver, a large one, or one at
// which that fails, with more iterations. What is best counts.
#include <algorithm>
#include <cmath>

#include <tactus/sim/rigid/rigid_parts.h>

namespace tactus::sim {

using namespace rigid;

namespace {

// For one cube on the floor QuickStep's error in the friction force falls from 3e-2 (20 iterations) over 1e-6 (50) to 1e-8 (100) of mu N.
constexpr int kMore = 10;                 // times the iterations
constexpr std::size_t kFewContacts = 40;  // for the direct solver, whose time grows with the third power
// A solid never is quite rigid: the direct solver needs that to choose among the many ways to carry a load. As fractions of the compliance
// 1/m of the lightest body; the first makes a cube with 1e5 times its weight on it sink by 0.02 mm.
constexpr double kCompliances[] = {4e-9, 1e-7};

double kinetic_energy(const Body& body, const Motion& motion) {
  const Vec3 w = rotate(conjugate(body.before.pose.rotation), motion.angular_velocity);
  return (body.spec.mass * dot(motion.velocity, motion.velocity) + dot(w, body.inertia.moments * w)) / 2;
}

Vec3 velocity_at(const Body& body, const Vec3& point) {
  const auto [v, w] = motion_of(body.handle);
  return v + cross(w, point - body.before.pose.position);
}

}  // namespace

/// Turn the contacts of a pair into joints.
void RigidWorld::Impl::attach(const Pair& pair) {
  const Body& first = bodies[pair.a];
  const Body* const second = body(pair.b);
  for (std::size_t i = pair.first; i < pair.first + pair.count; ++i) {
    dContact& contact = touching[i];
    contact.surface.mode = dContactApprox1 | dContactMotionN;
    contact.surface.mu = second ? std::min(first.mu, second->mu) : first.mu;
    const Vec3 point = vec(contact.geom.pos), normal = vec(contact.geom.normal);
    const Vec3 relative = velocity_without_contact(&first, point) - velocity_without_contact(second, point);
    const Vec3 sliding = relative - dot(relative, normal) * normal;
    if (const double speed = norm(sliding); speed > kSliding) {
      contact.surface.mode |= dContactFDir1;
      contact.fdir1[0] = sliding.x / speed;
      contact.fdir1[1] = sliding.y / speed;
      contact.fdir1[2] = sliding.z / speed;
    }
    const dJointID joint = dJointCreateContact(world, contacts, &contact);
    dJointAttach(joint, first.handle, second ? second->handle : nullptr);
    if (sends_loads) dJointSetFeedback(joint, &forces[i]);
  }
}

/// What the contacts of a pair can oppose to a motion along them.
void RigidWorld::Impl::add_hold(const Pair& pair) {
  for (std::size_t i = pair.first; i < pair.first + pair.count; ++i) {
    const Vec3 normal = vec(touching[i].geom.normal);
    const double pressed = std::max(0.0, dot(vec(forces[i].f1), normal)) / bodies[pair.a].fraction;
    const Vec3 limit = touching[i].surface.mu * pressed * normal;
    const auto add = [&limit](Vec3& hold) { hold = dot(hold, limit) < 0 ? hold - limit : hold + limit; };
    add(bodies[pair.a].load.hold);
    if (pair.b != kFloor) add(bodies[pair.b].load.hold);
  }
}

/// Of the bodies that were stepped, before their own forces are forgotten.
void RigidWorld::Impl::store_loads() {
  for (const std::uint32_t i : awake) {
    Body& body = bodies[i];
    const Vec3 change = vec(dBodyGetLinearVel(body.handle)) - body.stepped.velocity;
    body.load = {.external = (1 / body.fraction) * (body.spec.mass / h * change - body.applied.force), .hold = {}};
  }
  for (const Pair& pair : pairs) add_hold(pair);
}

/// Speed [m/s] at which ODE pushes bodies apart at a contact.
double RigidWorld::Impl::out_at(const dContact& contact) const {
  return dWorldGetERP(world) / h * std::max(0.0, contact.geom.depth - kSurfaceLayer) + contact.surface.motionN;
}

/// Speed [m/s] at which they still approach it.
double RigidWorld::Impl::left_at(const Pair& pair, const dContact& contact) const {
  const Vec3 point = vec(contact.geom.pos), normal = vec(contact.geom.normal);
  const Body* const second = body(pair.b);
  Vec3 relative = velocity_at(bodies[pair.a], point);
  if (second && second->handle) relative = relative - velocity_at(*second, point);
  return out_at(contact) - dot(relative, normal);
}

/// Of the group that was stepped last.
Residual RigidWorld::Impl::residual(const Group& group) const {
  Residual out;
  double mass = 0, created = 0, fastest_out = 0;
  for (const std::uint32_t i : group.members) {
    const Body& body = bodies[i];
    mass += body.spec.mass;
    created += kinetic_energy(body, motion_of(body.handle)) - kinetic_energy(body, body.free);
  }
  for (const Pair& pair : group.pairs) {
    for (const dContact& contact : std::span(touching).subspan(pair.first, pair.count)) {
      if (const double left = left_at(pair, contact); left > out.speed) out.speed = left, out.object = pair.a;
      fastest_out = std::max(fastest_out, out_at(contact));
    }
  }
  out.created = std::max(0.0, created);
  out.excess = std::sqrt(out.created / mass) - fastest_out;
  return out;
}

/// Bodies as they were before the step, with its forces.
void RigidWorld::Impl::put_back(const Group& group) const {
  for (const std::uint32_t i : group.members) {
    const Body& body = bodies[i];
    set_pose(body.handle, body.before.pose);
    set_motion(body.handle, body.stepped);
    add_forces(body);
  }
}

void RigidWorld::Impl::keep(const Group& group) {
  for (const std::uint32_t i : group.members) {
    Body& body = bodies[i];
    body.kept_pose = {vec(dBodyGetPosition(body.handle)), quaternion(body.handle)};
    body.kept_motion = motion_of(body.handle);
  }
  kept_forces = forces;
}

void RigidWorld::Impl::restore(const Group& group) {
  for (const std::uint32_t i : group.members) {
    const Body& body = bodies[i];
    set_pose(body.handle, body.kept_pose);
    set_motion(body.handle, body.kept_motion);
  }
  forces.swap(kept_forces);
}

/// in  most  iterations; 0: the direct solver
void RigidWorld::Impl::attempt(int most) const {
  dRandSetSeed(static_cast<unsigned long>(tick * parts + part));
  if (most == 0) {
    dWorldStep(world, h);
  } else {
    dWorldSetQuickStepNumIterations(world, most);
    dWorldQuickStep(world, h);
  }
}

/// Step the group again; the better of both results counts.
Residual RigidWorld::Impl::again(const Group& group, const Residual& left, int most) {
  keep(group);
  put_back(group);
  attempt(most);
  const Residual now = residual(group);
  if (now.badness() < left.badness()) return now;
  restore(group);
  return left;
}

/// The direct solver; where it fails, on a softer group.
Residual RigidWorld::Impl::solve_directly(const Group& group, Residual left) {
  double lightest = bodies[group.members.front()].spec.mass;
  for (const std::uint32_t i : group.members) lightest = std::min(lightest, bodies[i].spec.mass);
  const double compliance = dWorldGetCFM(world);
  for (const double fraction : kCompliances) {
    if (left.is_solution()) break;
    dWorldSetCFM(world, fraction / lightest);
    left = again(group, left, 0);
  }
  dWorldSetCFM(world, compliance);
  return left;
}

/// Step a group all of whose contacts are attached.
void RigidWorld::Impl::solve(const Group& group) {
  attempt(iterations);
  if (group.pairs.empty()) return;
  Residual left = residual(group);
  if (!left.is_solution()) {
    ++errors.solved_again;
    const std::size_t number = group.pairs.back().first + group.pairs.back().count - group.pairs.front().first;
    if (number <= kFewContacts) left = solve_directly(group, left);
    if (!left.is_solution()) left = again(group, left, kMore * iterations);
  }
  judge(group, left);
}

void RigidWorld::Impl::judge(const Group& group, const Residual& left) {
  ++errors.steps;
  if (!left.is_solution()) ++errors.unsolved;
  errors.residual.add(left.speed, tick, left.object);
  errors.contact_energy += left.created;
  for (const Pair& pair : group.pairs) {
    double depth = 0;
    for (const dContact& contact : std::span(touching).subspan(pair.first, pair.count))
      depth = std::max(depth, contact.geom.depth - kSurfaceLayer);
    for (const std::uint32_t i : {pair.a, pair.b}) {
      if (i == kFloor) continue;
      errors.objects[i].penetration = std::max(errors.objects[i].penetration, depth);
      errors.penetration.add(depth, tick, i);
    }
  }
  judge_momentum(group);
}

/// If nothing but its members and forces acts on it.
void RigidWorld::Impl::judge_momentum(const Group& group) {
  const auto is_free = [this](std::uint32_t i) { return bodies[i].spec.dof == Dof::all; };
  const auto is_among_them = [this](const Pair& pair) { return pair.b != kFloor && bodies[pair.b].handle; };
  if (!std::ranges::all_of(group.members, is_free) || !std::ranges::all_of(group.pairs, is_among_them)) return;
  Vec3 given;
  for (const std::uint32_t i : group.members) {
    const Body& body = bodies[i];
    given = given + body.spec.mass * (vec(dBodyGetLinearVel(body.handle)) - body.free.velocity);
  }
  errors.momentum = std::max(errors.momentum, norm(given));
}

/// QuickStep shuffles its constraints with the one random generator of the process. The generator is seeded and groups are stepped one
/// by one, so that a group's result depends on this group alone, not on other groups or whether they sleep.
void RigidWorld::Impl::step_groups() {
  const auto switch_all = [this](std::span<const std::uint32_t> which, void (*to)(dBodyID)) {
    for (const std::uint32_t i : which) to(bodies[i].handle);
  };
  if (sends_loads) forces.assign(touching.size(), {});
  const bool are_several = !groups.empty() && bodies[groups.front()].island != bodies[groups.back()].island;
  if (are_several) switch_all(groups, dBodyDisable);
  auto pair = pairs.begin();
  for (auto first = groups.begin(); first != groups.end();) {
    const std::uint32_t island = bodies[*first].island;
    const auto last = std::find_if(first, groups.end(), [&](std::uint32_t i) { return bodies[i].island != island; });
    const auto next = std::find_if(pair, pairs.end(), [&](const Pair& p) { return bodies[p.a].island != island; });
    const Group group{.members = {first, last}, .pairs = {pair, next}};
    dJointGroupEmpty(contacts);
    for (const Pair& p : group.pairs) attach(p);
    if (are_several) switch_all(group.members, dBodyEnable);
    solve(group);
    if (are_several) switch_all(group.members, dBodyDisable);
    first = last;
    pair = next;
  }
  if (are_several) switch_all(groups, dBodyEnable);
}

}  // namespace tactus::sim
