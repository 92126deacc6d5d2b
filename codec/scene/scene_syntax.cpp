// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/scene_syntax.h>

#include <algorithm>
#include <array>
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
constexpr std::size_t kFixedSize = 12;  // magic, version, profile, flags, body_size

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

// ==== parts ====
// What a scene may have. spec/20-scene.md section 4

bool moves(const SceneSpec& spec) noexcept {
  return std::ranges::any_of(spec.objects, [](const RigidObject& object) { return object.dof != Dof::none; });
}

RuleName broken_load_rule(const SceneSpec& spec) noexcept {
  const bool fits = spec.loads->force_exp <= LoadSpec::kMostExponent && spec.loads->users <= LoadSpec::kMostUsers;
  return moves(spec) && fits ? RuleName{} : RuleName{"R-STR-19"};
}

RuleName broken_motion_rule(const SceneSpec& spec) noexcept {
  constexpr std::int32_t kMost = MotionConstants::kMost;
  const MotionConstants& motion = *spec.motion;
  const bool fits = std::ranges::all_of(motion.gravity, [](std::int32_t g) { return g >= -kMost && g <= kMost; }) &&
                    motion.slide_deceleration >= 0 && motion.slide_deceleration <= kMost;
  return moves(spec) && fits && motion != MotionConstants{} ? RuleName{} : RuleName{"R-STR-22"};
}

RuleName broken_driven_rule(const SceneSpec& spec) noexcept {
  using Body = DrivenConstants::Body;
  const auto fits = [](std::uint32_t value) { return value >= 1 && value <= Body::kMost; };
  bool any = false, sound = spec.driven->bodies.size() == spec.objects.size();
  for (std::size_t i = 0; sound && i < spec.objects.size(); ++i) {
    const Body& body = spec.driven->bodies[i];
    if (body == Body{}) continue;
    any = true;
    sound = spec.objects[i].dof != Dof::none && fits(body.coupling) && body.hold <= Body::kMost &&
            std::ranges::all_of(body.inertia, fits);
  }
  return any && sound ? RuleName{} : RuleName{"R-STR-23"};
}

RuleName broken_interest_rule(const SceneSpec& spec) noexcept {
  const auto [full, reach] = *spec.interest;
  return moves(spec) && full >= 1 && full <= reach && reach <= Interest::kMost ? RuleName{} : RuleName{"R-STR-25"};
}

void parse_driven(ByteReader& body, SceneSpec& spec) {
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

struct Part {
  bool (*is_in)(const SceneSpec&);
  Result<void> (*parse)(ByteReader&, const DecodeLimits&,
                        SceneSpec&);  // what it does not check, its caller does: the end, then the rule
  void (*write)(ByteWriter&, const Scene&);
  RuleName (*broken_rule)(const SceneSpec&);  // of one that is in; null: checked where its elements are
};

/// By bit of `flags`.
constexpr std::array kParts{
    Part{[](const SceneSpec& s) { return !s.deformables.empty(); }, parse_deformables,
         [](ByteWriter& b, const Scene& s) {
           b.varint(s.deformables.size());
           for (const DeformableObject& object : s.deformables) write_deformable(b, object);
         },
         nullptr},
    Part{[](const SceneSpec& s) { return s.loads.has_value(); },
         [](ByteReader& in, const DecodeLimits&, SceneSpec& s) -> Result<void> {
           s.loads.emplace();
           s.loads->force_exp = in.u8();
           s.loads->users = in.u8();
           return {};
         },
         [](ByteWriter& b, const Scene& s) {
           b.u8(s.loads->force_exp);
           b.u8(s.loads->users);
         },
         broken_load_rule},
    Part{[](const SceneSpec& s) { return s.is_smoothed; },
         [](ByteReader&, const DecodeLimits&, SceneSpec& s) -> Result<void> {
           s.is_smoothed = true;
           return {};
         },
         [](ByteWriter&, const Scene&) {}, nullptr},
    Part{[](const SceneSpec& s) { return s.motion.has_value(); },
         [](ByteReader& in, const DecodeLimits&, SceneSpec& s) -> Result<void> {
           s.motion.emplace();
           for (std::int32_t& c : s.motion->gravity) c = in.i32();
           s.motion->slide_deceleration = in.i32();
           return {};
         },
         [](ByteWriter& b, const Scene& s) {
           for (const std::int32_t c : s.motion->gravity) b.i32(c);
           b.i32(s.motion->slide_deceleration);
         },
         broken_motion_rule},
    Part{[](const SceneSpec& s) { return s.driven.has_value(); },
         [](ByteReader& in, const DecodeLimits&, SceneSpec& s) -> Result<void> {
           parse_driven(in, s);
           return {};
         },
         write_driven, broken_driven_rule},
    Part{[](const SceneSpec& s) { return has_elastic_body(s.deformables); },
         [](ByteReader& in, const DecodeLimits&, SceneSpec& s) { return parse_elastic(in, s.deformables, s.grid.position); },
         [](ByteWriter& b, const Scene& s) { write_elastic(b, s.deformables); }, nullptr},
    Part{[](const SceneSpec& s) { return s.interest.has_value(); },
         [](ByteReader& in, const DecodeLimits&, SceneSpec& s) -> Result<void> {
           s.interest.emplace();
           s.interest->full = in.u32();
           s.interest->reach = in.u32();
           return {};
         },
         [](ByteWriter& b, const Scene& s) {
           b.u32(s.interest->full);
           b.u32(s.interest->reach);
         },
         broken_interest_rule},
};

std::uint16_t flags_of(const SceneSpec& spec) {
  unsigned flags = 0;
  for (std::size_t bit = 0; bit < kParts.size(); ++bit) flags |= kParts[bit].is_in(spec) ? 1u << bit : 0u;
  return static_cast<std::uint16_t>(flags);
}

Result<void> parse_part(const Part& part, ByteReader& body, const DecodeLimits& limits, SceneSpec& spec) {
  const std::uint64_t start = body.bit_offset();
  TACTUS_CHECK(part.parse(body, limits, spec));
  if (!body.ok()) return fail(Errc::truncated, "R-STR-5", body.bit_offset());
  const RuleName rule = part.broken_rule != nullptr ? part.broken_rule(spec) : RuleName{};
  if (rule) return fail(Errc::invalid, rule, start);
  return {};
}

// ==== body ====

Result<SceneSpec> parse_body(ByteReader body, std::uint16_t flags, const DecodeLimits& limits) {
  SceneSpec spec;
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
  for (std::size_t bit = 0; bit < kParts.size(); ++bit)
    if (flags >> bit & 1u) TACTUS_CHECK(parse_part(kParts[bit], body, limits, spec));
  TACTUS_CHECK(parse_extensions(body, spec));
  return spec;
}

}  // namespace

RuleName broken_part_rule(const SceneSpec& spec) noexcept {
  for (const Part& part : kParts) {
    if (part.broken_rule == nullptr || !part.is_in(spec)) continue;
    if (const RuleName rule = part.broken_rule(spec)) return rule;
  }
  return {};
}

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
  for (const Part& part : kParts)
    if (part.is_in(scene)) part.write(b, scene);
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
  w.u16(flags_of(scene));
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
  if (flags >> kParts.size() != 0) return fail(Errc::malformed, "R-STR-4", 48);
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
