// SPDX-License-Identifier: Apache-2.0
// Contacts between objects, and the groups they form.
#include <algorithm>
#include <cmath>
#include <tuple>

#include <tactus/sim/rigid/rigid_parts.h>

namespace tactus::sim {

using namespace rigid;

namespace {

constexpr double kSwept = 1e-4;     // [m] a pair that approaches by less in a tick is not swept
constexpr double kClose = 1e-5;     // [m] apart: the position of a touch is known well enough
constexpr double kMostLooks = 256;  // along the path of one tick

}  // namespace

/// With the displacement of this tick if nothing stops it.
Extent RigidWorld::Impl::bounds(std::uint32_t body) const {
  dReal box[6];
  dGeomGetAABB(bodies[body].geom, box);
  Extent out{{box[0], box[2], box[4]}, {box[1], box[3], box[5]}};
  const Vec3 d = displacement(body);
  (d.x < 0 ? out.low : out.high).x += d.x;
  (d.y < 0 ? out.low : out.high).y += d.y;
  (d.z < 0 ? out.low : out.high).z += d.z;
  return out;
}

/// [m] of the next tick, as if nothing touched it; zero for one that hardly moves.
Vec3 RigidWorld::Impl::displacement(std::uint32_t body) const {
  if (body == kFloor || !bodies[body].handle || !bodies[body].awake) return {};
  const Vec3 d = h * vec(dBodyGetLinearVel(bodies[body].handle));
  return norm(d) < kSwept ? Vec3{} : d;
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
  for (dContact& contact : std::span(found).first(static_cast<std::size_t>(count))) contact.surface = {};
  return on_mesh ? keep_outermost(std::span(found).first(static_cast<std::size_t>(count)), kMaxContacts) : count;
}

/// Contacts after a fraction of this tick's displacement, into `found`.
int RigidWorld::Impl::collide_at(const Pair& pair, double fraction) {
  const auto shift = [this](std::uint32_t body, double by) {
    const Vec3 d = displacement(body);
    if (d == Vec3{}) return;
    const Vec3 x = bodies[body].swept_from + by * d;
    dGeomSetPosition(bodies[body].geom, x.x, x.y, x.z);
  };
  for (const std::uint32_t i : {pair.a, pair.b})
    if (i != kFloor && bodies[i].handle) bodies[i].swept_from = vec(dBodyGetPosition(bodies[i].handle));
  shift(pair.a, fraction);
  shift(pair.b, fraction);
  const int count = collide(geom(pair.a), geom(pair.b));
  shift(pair.a, 0);
  shift(pair.b, 0);
  return count;
}

/// [m] edge of a body that may be passed unnoticed.
double RigidWorld::Impl::smallest(std::uint32_t body) const {
  const Vec3& size = bodies[body].spec.size;
  return std::min({size.x, size.y, size.z});
}

/// Two that do not touch yet, but do within this tick: they may come as near as they are, not nearer. Otherwise what is fast would pass
/// what is thin, or be found deep inside, and thrown out.
int RigidWorld::Impl::sweep(const Pair& pair) {
  const Vec3 moved_a = displacement(pair.a), moved_b = displacement(pair.b), relative = moved_a - moved_b;
  const double length = norm(relative);
  if (length < kSwept) return 0;
  double look = smallest(pair.a) / 2;
  if (moved_b != Vec3{}) look = std::min(look, smallest(pair.b) / 2);
  const double looks = std::min(kMostLooks, std::ceil(length / look));
  if (length > looks * 2 * look) errors.unswept.add(length / h, tick, moved_a == Vec3{} ? pair.b : pair.a);
  double before = 0, at = 0;
  for (double k = 1; k <= looks && at == 0; ++k) {
    if (collide_at(pair, k / looks) > 0) at = k / looks;
    else before = k / looks;
  }
  if (at == 0) return 0;
  while ((at - before) * length > kClose) {
    const double middle = (before + at) / 2;
    (collide_at(pair, middle) > 0 ? at : before) = middle;
  }
  const int count = collide_at(pair, at);
  int kept = 0;
  for (dContact& contact : std::span(found).first(static_cast<std::size_t>(count))) {
    const double nearer = -at * dot(vec(contact.geom.normal), relative);
    if (nearer <= 0) continue;
    contact.surface.motionN = -(nearer - contact.geom.depth) / h;
    contact.geom.depth = 0;
    const Vec3 back = pair.b == kFloor || !bodies[pair.b].handle ? at * moved_a : (0.5 * at) * (moved_a + moved_b);
    for (int k = 0; k < 3; ++k) contact.geom.pos[k] -= (&back.x)[k];
    found[static_cast<std::size_t>(kept++)] = contact;
  }
  return kept;
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
      if (!body.handle || body.awake || (collide(geom(i), body.geom) == 0 && sweep({.a = i, .b = other}) == 0)) return;
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
    int count = collide(geom(pair.a), geom(pair.b));
    pair.first = touching.size();
    if (count == 0) count = sweep(pair);
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

}  // namespace tactus::sim
