// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/scene_syntax.h>

#include <algorithm>
#include <string_view>
#include <unordered_set>

#include <tactus/base/bytes.h>
#include <tactus/base/fixed.h>
#include <tactus/base/rule.h>
#include <tactus/scene/deformable_syntax.h>
#include <tactus/scene/elastic_syntax.h>
#include <tactus/scene/scene_rules.h>

namespace tactus {
namespace {

constexpr std::array<std::uint8_t, 4> kMagic{0x89, 'T', 'C', 'T'};
constexpr std::uint8_t kRigid = 1;
constexpr std::uint8_t kProfile = 0;
constexpr std::uint16_t kHasDeformables = 1, kHasLoads = 2, kIsSmoothed = 4, kHasMotion = 8, kIsDriven = 16, kIsElastic = 32,
                        kHasInterest = 64;  // flags
constexpr std::size_t kFixedSize = 12;      // magic, version, profile, flags, body_size

Result<RigidObject> parse_object(ByteReader& body) {
  const std::uint64_t start = body.bit_offset();
  const std::uint8_t kind = body.u8();
  if (body.ok() && kind != kRigid) return fail(Errc::unsupported, "R-STR-10", start);
  RigidObject object;
  object.dof = body.u8();
  const auto name = body.bytes(body.u8());
  object.name.assign(name.begin(), name.end());
  for (auto& c : object.initial.position) c = body.i32();
  for (auto& c : object.initial.rotation) c = body.i32();
  if (!body.ok()) return fail(class_of_overflow(body), "R-STR-5", body.bit_offset());
  if (const RuleName rule = broken_object_rule(object)) return fail(Errc::invalid, rule, start);
  return object;
}

/// Records of unknown type are skipped.
Result<void> parse_extensions(ByteReader& body, SceneSpec& spec) {
  while (body.remaining() > 0) {
    const std::uint64_t type = body.varint();
    ByteReader data = body.sub(body.varint());
    if (!body.ok()) return fail(Errc::malformed, "R-STR-16", body.bit_offset());
    if (type == kStiffnessRecord) TACTUS_CHECK(parse_stiffness(data, spec.deformables));
    if (type != kBoundsRecord) continue;
    if (spec.bounds) return fail(Errc::invalid, "R-STR-17", data.bit_offset());
    TACTUS_TRY(spec.bounds, parse_bounds(data, spec));
  }
  return {};
}

Result<void> parse_deformables(ByteReader& body, const DecodeLimits& limits, SceneSpec& spec) {
  const std::uint64_t count = body.varint();
  if (!body.ok()) return fail(class_of_overflow(body), "R-STR-5", body.bit_offset());
  if (count < 1) return fail(Errc::malformed, "R-DEF-1", body.bit_offset());
  if (count > kMaxDeformables) return fail(Errc::invalid, "R-DEF-1", body.bit_offset());
  if (count > limits.objects - spec.objects.size()) return fail(Errc::limit_exceeded, "R-STR-14", body.bit_offset());
  DeformableRoom room{limits.vertices, limits.triangles, limits.thesis != nullptr};
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t start = body.bit_offset();
    TACTUS_TRY(auto object, parse_deformable(body, room));
    if (!is_name(object.name)) return fail(Errc::invalid, "R-STR-11", start);
    room.vertices -= object.rest.size();
    room.triangles -= object.triangles.size();
    spec.deformables.push_back(std::move(object));
  }
  return {};
}

Result<void> parse_loads(ByteReader& body, SceneSpec& spec) {
  const std::uint64_t start = body.bit_offset();
  LoadSpec& loads = spec.loads.emplace();
  loads.force_exp = body.u8();
  loads.users = body.u8();
  if (!body.ok()) return fail(Errc::truncated, "R-STR-5", body.bit_offset());
  if (const RuleName rule = broken_load_rule(spec)) return fail(Errc::invalid, rule, start);
  return {};
}

Result<void> parse_motion(ByteReader& body, SceneSpec& spec) {
  const std::uint64_t start = body.bit_offset();
  MotionConstants& motion = spec.motion.emplace();
  for (auto& c : motion.gravity) c = body.i32();
  motion.slide_deceleration = body.i32();
  if (!body.ok()) return fail(Errc::truncated, "R-STR-5", body.bit_offset());
  if (const RuleName rule = broken_motion_rule(spec)) return fail(Errc::invalid, rule, start);
  return {};
}

Result<void> parse_driven(ByteReader& body, SceneSpec& spec) {
  const std::uint64_t start = body.bit_offset();
  DrivenConstants& driven = spec.driven.emplace();
  driven.bodies.resize(spec.objects.size());
  for (std::size_t i = 0; i < spec.objects.size(); ++i) {
    if (spec.objects[i].dof == Dof::none) continue;
    driven.bodies[i].coupling = body.u32();
    driven.bodies[i].hold = body.u32();
    for (std::uint32_t& c : driven.bodies[i].inertia) c = body.u32();
    driven.bodies[i].friction = body.u16();
    driven.bodies[i].damping = body.u16();
  }
  if (!body.ok()) return fail(Errc::truncated, "R-STR-5", body.bit_offset());
  if (const RuleName rule = broken_driven_rule(spec)) return fail(Errc::invalid, rule, start);
  return {};
}

Result<void> parse_interest(ByteReader& body, SceneSpec& spec) {
  const std::uint64_t start = body.bit_offset();
  Interest& interest = spec.interest.emplace();
  interest.full = body.u32();
  interest.reach = body.u32();
  if (!body.ok()) return fail(Errc::truncated, "R-STR-5", body.bit_offset());
  if (const RuleName rule = broken_interest_rule(spec)) return fail(Errc::invalid, rule, start);
  return {};
}

void write_driven(ByteWriter& b, const Scene& scene) {
  for (const std::uint32_t i : scene.moving()) {
    b.u32(scene.driven->bodies[i].coupling);
    b.u32(scene.driven->bodies[i].hold);
    for (const std::uint32_t c : scene.driven->bodies[i].inertia) b.u32(c);
    b.u16(scene.driven->bodies[i].friction);
    b.u16(scene.driven->bodies[i].damping);
  }
}

Result<SceneSpec> parse_body(ByteReader body, std::uint16_t flags, const DecodeLimits& limits) {
  SceneSpec spec;
  spec.is_smoothed = (flags & kIsSmoothed) != 0;
  const std::uint64_t start = body.bit_offset();
  spec.tick_rate = body.u32();
  spec.grid.position = body.u8();
  spec.grid.velocity = body.u8();
  spec.grid.rotation = body.u8();
  spec.grid.angular_velocity = body.u8();
  spec.max_extrapolation = body.u16();
  spec.baseline_span = body.u8();
  const std::uint64_t count = body.varint();
  if (!body.ok()) return fail(class_of_overflow(body), "R-STR-5", body.bit_offset());
  if (const RuleName rule = broken_parameter_rule(spec)) return fail(Errc::invalid, rule, start);
  if (count > limits.objects) return fail(Errc::limit_exceeded, "R-STR-14", body.bit_offset());
  constexpr std::size_t kSmallestObject = 3 + 1 + 7 * 4;
  if (count > body.remaining() / kSmallestObject) return fail(Errc::truncated, "R-STR-5", body.bit_offset());
  spec.objects.reserve(static_cast<std::size_t>(count));
  for (std::uint64_t i = 0; i < count; ++i) {
    TACTUS_TRY(auto object, parse_object(body));
    spec.objects.push_back(std::move(object));
  }
  if (flags & kHasDeformables) TACTUS_CHECK(parse_deformables(body, limits, spec));
  if (flags & kHasLoads) TACTUS_CHECK(parse_loads(body, spec));
  if (flags & kHasMotion) TACTUS_CHECK(parse_motion(body, spec));
  if (flags & kIsDriven) TACTUS_CHECK(parse_driven(body, spec));
  if (flags & kIsElastic) TACTUS_CHECK(parse_elastic(body, spec.deformables, spec.grid.position));
  if (flags & kHasInterest) TACTUS_CHECK(parse_interest(body, spec));
  TACTUS_CHECK(parse_extensions(body, spec));
  return spec;
}

}  // namespace

Result<std::vector<std::uint8_t>> write_scene(const Scene& scene) try {
  std::vector<std::uint8_t> body;
  ByteWriter b(body);
  b.u32(scene.tick_rate);
  b.u8(scene.grid.position);
  b.u8(scene.grid.velocity);
  b.u8(scene.grid.rotation);
  b.u8(scene.grid.angular_velocity);
  b.u16(scene.max_extrapolation);
  b.u8(scene.baseline_span);
  b.varint(scene.objects.size());
  for (const RigidObject& object : scene.objects) {
    b.u8(kRigid);
    b.u8(object.dof);
    b.u8(static_cast<std::uint8_t>(object.name.size()));
    b.bytes({reinterpret_cast<const std::uint8_t*>(object.name.data()), object.name.size()});
    for (const std::int32_t c : object.initial.position) b.i32(c);
    for (const std::int32_t c : object.initial.rotation) b.i32(c);
  }
  if (!scene.deformables.empty()) b.varint(scene.deformables.size());
  for (const DeformableObject& object : scene.deformables) write_deformable(b, object);
  if (scene.loads) {
    b.u8(scene.loads->force_exp);
    b.u8(scene.loads->users);
  }
  if (scene.motion) {
    for (const std::int32_t c : scene.motion->gravity) b.i32(c);
    b.i32(scene.motion->slide_deceleration);
  }
  if (scene.driven) write_driven(b, scene);
  if (has_elastic_body(scene.deformables)) write_elastic(b, scene.deformables);
  if (scene.interest) {
    b.u32(scene.interest->full);
    b.u32(scene.interest->reach);
  }
  if (scene.bounds) {
    const auto bounds = write_bounds(*scene.bounds);
    b.varint(kBoundsRecord);
    b.varint(bounds.size());
    b.bytes(bounds);
  }
  for (std::size_t i = 0; i < scene.deformables.size(); ++i)
    if (const auto& object = scene.deformables[i]; !object.stiffness.empty())
      write_stiffness(b, static_cast<std::uint8_t>(i), object);
  std::vector<std::uint8_t> out;
  out.reserve(kFixedSize + body.size() + 4);
  ByteWriter w(out);
  for (const std::uint8_t byte : kMagic) w.u8(byte);
  w.u8(kFormatVersion);
  w.u8(kProfile);
  w.u16(static_cast<std::uint16_t>((scene.deformables.empty() ? 0 : kHasDeformables) | (scene.loads ? kHasLoads : 0) |
                                   (scene.is_smoothed ? kIsSmoothed : 0) | (scene.motion ? kHasMotion : 0) |
                                   (scene.driven ? kIsDriven : 0) | (has_elastic_body(scene.deformables) ? kIsElastic : 0) |
                                   (scene.interest ? kHasInterest : 0)));
  w.u32(static_cast<std::uint32_t>(body.size()));
  w.bytes(body);
  w.u32(crc32(out));
  return out;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<ParsedScene> parse_scene(std::span<const std::uint8_t> bytes, const DecodeLimits& limits) try {
  ByteReader in(bytes);
  const auto magic = in.bytes(kMagic.size());
  if (!in.ok()) return fail(Errc::truncated, "R-STR-1");
  if (!std::ranges::equal(magic, kMagic)) return fail(Errc::malformed, "R-STR-1");
  const std::uint8_t version = in.u8();
  const std::uint8_t profile = in.u8();
  const std::uint16_t flags = in.u16();
  const std::uint32_t body_size = in.u32();
  if (!in.ok()) return fail(Errc::truncated, "R-STR-5", in.bit_offset());
  if (version != kFormatVersion) return fail(Errc::unsupported, "R-STR-2", 32);
  if (profile > kProfile + 1) return fail(Errc::malformed, "R-STR-3", 40);
  if (profile != kProfile) return fail(Errc::unsupported, "R-STR-3", 40);
  constexpr std::uint16_t kAll = kHasDeformables | kHasLoads | kIsSmoothed | kHasMotion | kIsDriven | kIsElastic | kHasInterest;
  if (flags > kAll) return fail(Errc::malformed, "R-STR-4", 48);
  if (body_size > limits.header_bytes) return fail(Errc::limit_exceeded, "R-STR-14", 64);
  ByteReader body = in.sub(body_size);
  const std::uint32_t crc = in.u32();
  if (!in.ok()) return fail(Errc::truncated, "R-STR-5", in.bit_offset());
  if (crc != crc32(bytes.first(kFixedSize + body_size))) return fail(Errc::checksum, "R-STR-15", in.bit_offset() - 32);
  TACTUS_TRY(SceneSpec spec, parse_body(body, flags, limits));
  auto scene = Scene::create(std::move(spec), limits);
  if (!scene) return fail_at(scene.error(), 96);
  return ParsedScene{std::move(*scene), in.position()};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

}  // namespace tactus
