// SPDX-License-Identifier: Apache-2.0
/// Any constants, materials and tetrahedra as an elastic body, any device that touches it: both ends compute the same, and nothing breaks.
#include <bit>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/deformable/main_state.h>
#include <tactus/elastic/driven_shape.h>
#include <tactus/rigid/device_path.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/scene/scene_syntax.h>
#include "tests/fuzz/require.h"

namespace {

using namespace tactus;

/// Of any bits, or of a size that a body has.
double constant(ByteReader& in, double usual) {
  const std::uint8_t kind = in.u8();
  if (kind < 16) return std::bit_cast<double>(in.u64());
  return usual * std::ldexp(1 + in.u8() / 256.0, kind % 32 - 16);
}

/// A few vertices, all on the surface or not, and whatever the bytes make of them.
DeformableObject object(ByteReader& in) {
  DeformableObject out;
  out.name = "body";
  out.frame_period = 256u * (1 + in.u8() % 12);
  const std::size_t vertices = 4 + in.u8() % 9, inner = in.u8() % 4;
  const auto position = [&]() -> Vec3i {
    Vec3i at{};
    for (std::int32_t& c : at) c = static_cast<std::int16_t>(in.u16()) * 4;
    return at;
  };
  for (std::size_t v = 0; v < vertices; ++v) out.rest.push_back(position());
  for (std::size_t t = in.u8() % 16; t > 0; --t)
    out.triangles.push_back({in.u8() % static_cast<std::uint32_t>(vertices), in.u8() % static_cast<std::uint32_t>(vertices),
                             in.u8() % static_cast<std::uint32_t>(vertices)});
  ElasticBody& body = out.body.emplace();
  for (std::size_t v = 0; v < inner; ++v) body.inner.push_back(position());
  const auto all = static_cast<std::uint32_t>(vertices + inner);
  for (std::size_t m = 1 + in.u8() % 3; m > 0; --m) {
    const double young = constant(in, 1e4), poisson = in.u8() < 250 ? 0.45 - 0.003 * in.u8() : constant(in, 0.4);
    body.materials.push_back({young, poisson, constant(in, 1000)});
  }
  for (std::size_t t = 1 + in.u8() % 16; t > 0; --t) {
    body.tets.push_back({in.u8() % all, in.u8() % all, in.u8() % all, in.u8() % all});
    body.material.push_back(static_cast<std::uint8_t>(in.u8() % body.materials.size()));
  }
  for (std::uint32_t v = in.u8() % 4; v < all && body.fixed.size() < 4; v += 1u + in.u8() % 8) body.fixed.push_back(v);
  body.mass_damping = constant(in, 1);
  body.stiffness_damping = constant(in, 0.004);
  body.coupling = constant(in, 5);
  body.friction = in.u8() % 2 == 0 ? 0 : constant(in, 0.5);
  if (const unsigned kind = in.u8() % 8; kind < 4) {
    body.method = kind < 2 ? ElasticBody::Method::velocity_verlet : ElasticBody::Method::tr_bdf2;
    if (kind < 2) body.sub_steps = in.u8() % 32;
  }
  if (in.u8() % 4 == 0) body.gravity = {constant(in, 1), constant(in, -1), constant(in, -9.81)};
  return out;
}

/// Tetrahedra that are inside out are turned, and those without volume left out, so that more bodies are whole.
void repair(DeformableObject& object) {
  ElasticBody& body = *object.body;
  std::vector<ElasticBody::Tet> tets;
  std::vector<std::uint8_t> material;
  for (std::size_t t = 0; t < body.tets.size(); ++t) {
    ElasticBody::Tet tet = body.tets[t];
    const auto at = [&](std::uint32_t v) {
      const Vec3i& p = v < object.rest.size() ? object.rest[v] : body.inner[v - object.rest.size()];
      return Vec3{double(p[0]), double(p[1]), double(p[2])};
    };
    const double six = dot(cross(at(tet[1]) - at(tet[0]), at(tet[2]) - at(tet[0])), at(tet[3]) - at(tet[0]));
    if (six < 0) std::swap(tet[2], tet[3]);
    if (six == 0) continue;
    tets.push_back(tet);
    material.push_back(body.material[t]);
  }
  body.tets = tets;
  body.material = material;
}

RigidState device(const Scene& scene, std::int64_t tick, const Vec3i& near, ByteReader& in) {
  RigidSample sample;
  const auto offset = [&] { return std::ldexp(static_cast<std::int8_t>(in.u8()) * 64.0, -22); };
  sample.pose.position = {std::ldexp(near[0], -22) + offset(), std::ldexp(near[1], -22) + offset(),
                          std::ldexp(near[2], -22) + offset()};
  return to_grid(sample, tick, scene.grid).value();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ByteReader in({data, size});
  SceneSpec spec;
  spec.deformables.push_back(object(in));
  if (in.u8() % 8 != 0) repair(spec.deformables[0]);
  const auto scene = Scene::create(std::move(spec));
  if (!scene) return 0;
  const auto bytes = write_scene(**scene);
  const auto parsed = parse_scene(*bytes);
  require(parsed.has_value() && parsed->scene->deformables == (*scene)->deformables);

  const DeformableObject& of = (*scene)->deformables[0];
  const auto known = std::make_unique<DevicePath>(device_scene(**scene).value()),
             signalled = std::make_unique<DevicePath>(device_scene(**scene).value());
  for (DevicePath* path : {known.get(), signalled.get()}) path->shift(0, 0);
  DrivenShape knows(**scene, of, *known), learns(**scene, of, *signalled);
  std::vector<Vec3i> a(of.rest.size()), b(of.rest.size());
  std::int64_t tick = 0;
  for (std::uint64_t number = 1; in.ok() && number < 200; ++number) {
    tick += 1 + in.u8() % 12;
    const RigidState state = device(**scene, tick, of.rest[in.u8() % of.rest.size()], in);
    const bool takes_effect = in.u8() % 8 != 0;
    if (takes_effect) known->add(number, state);
    signalled->add(number, state);
    (void)learns.body_at(tick, b);
    signalled->settle(number, [&](std::uint64_t n) { return n != number || takes_effect; });
    const bool there = knows.body_at(tick, a);
    require(learns.body_at(tick, b) == there);
    require(!there || a == b);
  }
  MainState state = initial_main_state(of);
  state.tick = tick / 2;
  state.following = tick % 2 == 0 ? Following::kept : Following::fading;
  (void)knows.show(state, tick, a);
  return 0;
}
