// SPDX-License-Identifier: Apache-2.0
// Contacts between objects, and the steps of the groups they form.
#include <algorithm>
#include <tuple>

#include <tactus/sim/rigid/rigid_parts.h>

namespace tactus::sim {

using namespace rigid;

Extent RigidWorld::Impl::bounds(std::uint32_t body) const {
  dReal box[6];
  dGeomGetAABB(bodies[body].geom, box);
  return {{box[0], box[2], box[4]}, {box[1], box[3], box[5]}};
}

void RigidWorld::Impl::rebuild_resting() {
  resting.clear();
  for (std::uint32_t i = 0; i < bodies.size(); ++i)
    if (!bodies[i].awake) resting.add({i, bounds(i)});
  resting.build();
  resting_is_old = false;
}

/// Contacts of two geoms, into `found`.
int RigidWorld::Impl::collide(dGeomID a, dGeomID b) {
  const bool on_mesh = dGeomGetClass(a) == dTriMeshClass || dGeomGetClass(b) == dTriMeshClass;
  const int count = dCollide(a, b, on_mesh ? kMostFound : kMaxContacts, &found[0].geom, sizeof(dContact));
  return on_mesh ? keep_outermost(std::span(found).first(static_cast<std::size_t>(count)), kMaxContacts) : count;
}

/// Test awake bodies against resting ones. A sleeping body that is hit wakes, and so do the bodies it touches.
void RigidWorld::Impl::find_pairs() {
  pairs.clear();
  groups = awake;  // grows in the loop
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const std::uint32_t i = groups[k];
    const Extent box = bounds(i);
    if (floor && box.low.z <= floor_height) pairs.push_back({i, kFloor});
    resting.visit(box, [&](std::uint32_t other) {
      Body& body = bodies[other];
      if (!body.handle) pairs.push_back({i, other});
      if (!body.handle || body.awake || collide(geom(i), body.geom) == 0) return;
      wake(other);
      groups.push_back(other);
    });
  }
  find_pairs_among_awake();
}

/// Sweep and prune along x.
void RigidWorld::Impl::find_pairs_among_awake() {
  order.clear();
  for (const std::uint32_t i : awake) order.emplace_back(bounds(i).low.x, i);
  std::sort(order.begin(), order.end());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Extent box = bounds(order[k].second);
    for (std::size_t l = k + 1; l < order.size() && order[l].first <= box.high.x && pairs.size() <= kMostPairs; ++l)
      if (overlap(box, bounds(order[l].second)))
        pairs.push_back({std::min(order[k].second, order[l].second), std::max(order[k].second, order[l].second)});
  }
}

/// Find the contacts of all pairs and the groups they form. False if there are too many contacts.
bool RigidWorld::Impl::find_contacts() {
  touching.clear();
  for (const std::uint32_t i : awake) {
    bodies[i].group = i;
    bodies[i].touches = false;
  }
  for (Pair& pair : pairs) {
    const int count = collide(geom(pair.a), geom(pair.b));
    pair.first = touching.size();
    pair.count = static_cast<std::size_t>(count);
    touching.insert(touching.end(), found.begin(), found.begin() + count);
    if (touching.size() > kMostTouching) return false;
    if (count == 0) continue;
    bodies[pair.a].touches = true;
    if (pair.b == kFloor || !bodies[pair.b].handle) continue;
    bodies[pair.b].touches = true;
    bodies[group_of(pair.b)].group = group_of(pair.a);
    if (ends_period()) watch.touch(bodies[pair.a].mover, bodies[pair.b].mover);
  }
  return true;
}

std::uint32_t RigidWorld::Impl::group_of(std::uint32_t body) {
  while (bodies[body].group != body) body = bodies[body].group = bodies[bodies[body].group].group;
  return body;
}

/// Turn the contacts of a pair into joints.
void RigidWorld::Impl::attach(const Pair& pair) {
  const Body& first = bodies[pair.a];
  const Body* const second = body(pair.b);
  for (std::size_t i = pair.first; i < pair.first + pair.count; ++i) {
    dContact& contact = touching[i];
    contact.surface = {};
    contact.surface.mode = dContactApprox1;
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
    if (tells_loads) dJointSetFeedback(joint, &forces[i]);
  }
}

/// Sort bodies and pairs by group. Bodies that touch nothing form one group, without pairs.
void RigidWorld::Impl::make_groups() {
  for (const std::uint32_t i : awake) bodies[i].island = bodies[i].touches ? group_of(i) : kFloor;
  std::erase_if(pairs, [](const Pair& pair) { return pair.count == 0; });
  std::sort(pairs.begin(), pairs.end(), [this](const Pair& x, const Pair& y) {
    return std::tuple(bodies[x.a].island, x.a, x.b) < std::tuple(bodies[y.a].island, y.a, y.b);
  });
  groups = awake;
  std::sort(groups.begin(), groups.end(),
            [this](std::uint32_t a, std::uint32_t b) { return std::pair(bodies[a].island, a) < std::pair(bodies[b].island, b); });
}

/// What the contacts of a pair can oppose to a motion along them.
void RigidWorld::Impl::add_hold(const Pair& pair) {
  for (std::size_t i = pair.first; i < pair.first + pair.count; ++i) {
    const Vec3 normal = vec(touching[i].geom.normal);
    const Vec3 limit = touching[i].surface.mu * std::max(0.0, dot(vec(forces[i].f1), normal)) * normal;
    const auto add = [&limit](Vec3& hold) { hold = dot(hold, limit) < 0 ? hold - limit : hold + limit; };
    add(bodies[pair.a].load.hold);
    if (pair.b != kFloor) add(bodies[pair.b].load.hold);
  }
}

/// Of the bodies that were stepped, before their own forces are forgotten.
void RigidWorld::Impl::tell_loads() {
  for (const std::uint32_t i : awake) {
    Body& body = bodies[i];
    const Vec3 change = vec(dBodyGetLinearVel(body.handle)) - body.before.velocity;
    body.load = {.external = body.spec.mass / kTick * change - body.force, .hold = {}};
  }
  for (const Pair& pair : pairs) add_hold(pair);
}

/// QuickStep shuffles its constraints with the one random generator of the process. The generator is seeded and groups are stepped one
/// by one, so that a group's result depends on this group alone, not on other groups or whether they sleep.
void RigidWorld::Impl::step_groups() {
  const auto switch_all = [this](void (*to)(dBodyID)) {
    for (const std::uint32_t i : groups) to(bodies[i].handle);
  };
  if (tells_loads) forces.assign(touching.size(), {});
  const bool are_several = !groups.empty() && bodies[groups.front()].island != bodies[groups.back()].island;
  if (are_several) switch_all(dBodyDisable);
  auto pair = pairs.begin();
  for (auto first = groups.begin(); first != groups.end();) {
    const std::uint32_t island = bodies[*first].island;
    const auto last = std::find_if(first, groups.end(), [&](std::uint32_t i) { return bodies[i].island != island; });
    dJointGroupEmpty(contacts);
    for (; pair != pairs.end() && bodies[pair->a].island == island; ++pair) attach(*pair);
    if (are_several)
      for (auto i = first; i != last; ++i) dBodyEnable(bodies[*i].handle);
    dRandSetSeed(static_cast<unsigned long>(tick));
    dWorldQuickStep(world, kTick);
    if (are_several)
      for (auto i = first; i != last; ++i) dBodyDisable(bodies[*i].handle);
    first = last;
  }
  if (are_several) switch_all(dBodyEnable);
}

}  // namespace tactus::sim
