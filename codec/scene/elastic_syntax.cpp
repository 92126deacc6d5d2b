// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/elastic_syntax.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include <tactus/base/fixed.h>
#include <tactus/base/rule.h>
#include <tactus/base/tri_mesh.h>
#include <tactus/mesh/elastic_elements.h>
#include <tactus/scene/scene_objects.h>
#include <tactus/scene/scene_rules.h>

namespace tactus {

// ==== bounds syntax ====

namespace {

constexpr std::uint8_t kKept = 1;  // bits of `bound_flags`
constexpr std::uint8_t kHaptic = 2;

/// One walk over the record's elements to check, write and read them. `Coder` has number(v) and byte(v, limit), which return the
/// value that is there.
template <class Coder>
void code_rigid(Coder& coder, RigidTriggers& t) {
  t.heartbeat = coder.number(t.heartbeat);
  t.visual_position = coder.number(t.visual_position);
  t.visual_rotation = coder.number(t.visual_rotation);
  t.haptic = static_cast<HapticRule>(coder.byte(static_cast<std::uint8_t>(t.haptic), 4));
  const bool is_constant = t.haptic == HapticRule::isotropic || t.haptic == HapticRule::cone;
  if (is_constant) t.weber_fraction = coder.number(t.weber_fraction);
  if (t.haptic == HapticRule::perceptual) t.perceptual_fraction = coder.number(t.perceptual_fraction);
  if (is_constant || t.haptic == HapticRule::perceptual) t.force_floor = coder.number(t.force_floor);
  if (t.haptic == HapticRule::cone) t.cone_angle = coder.number(t.cone_angle);
  if (t.haptic == HapticRule::fixed) {
    t.fixed_position = coder.number(t.fixed_position);
    t.fixed_rotation = coder.number(t.fixed_rotation);
  }
}

template <class Coder>
void code_deformable(Coder& coder, DeformableBounds& mesh) {
  DeformableThresholds& t = mesh.thresholds;
  const unsigned bound_flags = (mesh.kept ? kKept : 0u) | (t.weber_fraction ? kHaptic : 0u);
  const std::uint8_t flags = coder.byte(static_cast<std::uint8_t>(bound_flags), kKept | kHaptic);
  mesh.kept = (flags & kKept) != 0;
  t.visual = coder.number(t.visual);
  if (!(flags & kHaptic)) {
    t.weber_fraction.reset();
    return;
  }
  t.weber_fraction = coder.number(t.weber_fraction.value_or(0));
  t.depth_floor = coder.number(t.depth_floor);
}

template <class Coder>
void code_loads(Coder& coder, LoadThresholds& t) {
  t.weber_fraction = coder.number(t.weber_fraction);
  t.force_floor = coder.number(t.force_floor);
}

template <class Coder>
void code_bounds(Coder& coder, StreamBounds& bounds) {
  if (bounds.rigid) code_rigid(coder, *bounds.rigid);
  for (DeformableBounds& mesh : bounds.deformables) code_deformable(coder, mesh);
  if (bounds.loads) code_loads(coder, *bounds.loads);
}

/// Finite and without a sign.
bool is_number(double v) noexcept { return std::bit_cast<std::uint64_t>(v) < 0x7ff0000000000000u; }

struct Checker {
  double number(double v) noexcept {
    sound = sound && is_number(v);
    return v;
  }
  std::uint8_t byte(std::uint8_t v, unsigned limit) noexcept {
    sound = sound && v <= limit;
    return v;
  }
  bool sound = true;
};

struct Writer {
  double number(double v) {
    out.u64(std::bit_cast<std::uint64_t>(v));
    return v;
  }
  std::uint8_t byte(std::uint8_t v, unsigned) {
    out.u8(v);
    return v;
  }
  ByteWriter out;
};

struct Reader {
  double number(double) noexcept { return check.number(std::bit_cast<double>(in.u64())); }
  std::uint8_t byte(std::uint8_t, unsigned limit) noexcept { return check.byte(in.u8(), limit); }
  ByteReader& in;
  Checker check{};
};

bool has_moving(const SceneSpec& spec) noexcept {
  return std::ranges::any_of(spec.objects, [](const RigidObject& o) { return o.dof != Dof::none; });
}

}  // namespace

StreamBounds bounds_of(const SceneSpec& spec, const RigidTriggers& rigid, const DeformableThresholds& deformables,
                       const LoadThresholds& loads) {
  StreamBounds bounds;
  if (has_moving(spec)) bounds.rigid = rigid;
  for (const DeformableObject& object : spec.deformables)
    bounds.deformables.push_back({deformables, object.profile == DeformableProfile::main});
  if (spec.loads) bounds.loads = loads;
  return bounds;
}

bool are_bounds(const SceneSpec& spec) noexcept {
  const StreamBounds& bounds = *spec.bounds;
  if (bounds.rigid.has_value() != has_moving(spec) || bounds.deformables.size() != spec.deformables.size()) return false;
  if (bounds.loads.has_value() != spec.loads.has_value()) return false;
  Checker checker;
  if (bounds.rigid) {
    RigidTriggers rigid = *bounds.rigid;
    code_rigid(checker, rigid);
  }
  for (DeformableBounds mesh : bounds.deformables) code_deformable(checker, mesh);
  if (bounds.loads) {
    LoadThresholds loads = *bounds.loads;
    code_loads(checker, loads);
  }
  return checker.sound;
}

std::vector<std::uint8_t> write_bounds(StreamBounds bounds) {
  std::vector<std::uint8_t> out;
  Writer writer{ByteWriter(out)};
  code_bounds(writer, bounds);
  return out;
}

Result<StreamBounds> parse_bounds(ByteReader& in, const SceneSpec& spec) {
  StreamBounds bounds;
  if (has_moving(spec)) bounds.rigid.emplace();
  bounds.deformables.resize(spec.deformables.size());
  if (spec.loads) bounds.loads.emplace();
  Reader reader{in};
  code_bounds(reader, bounds);
  if (!reader.check.sound) return fail(Errc::invalid, "R-STR-17", in.bit_offset());
  if (!in.ok()) return fail(Errc::truncated, "R-STR-17", in.bit_offset());
  return bounds;
}

// ==== elastic syntax ====

namespace {

constexpr std::uint32_t kNoVertex = 0xffffffff;
constexpr auto kMostMethod = static_cast<std::uint8_t>(ElasticBody::Method::velocity_verlet);

bool can_have_body(const DeformableObject& object) noexcept {
  return object.profile == DeformableProfile::main && !object.layered && object.frame_period % 256 == 0 &&
         object.frame_period <= 256 * ElasticBody::kMostTicks;
}

bool are_sub_steps(const ElasticBody& body) noexcept {
  return body.method == ElasticBody::Method::velocity_verlet ? body.sub_steps >= 1 : body.sub_steps == 1;
}

bool are_constants(const ElasticBody& body) noexcept {
  const auto size = [](double v) { return v >= 0 && v <= ElasticBody::kLargest; };
  return size(body.mass_damping) && size(body.stiffness_damping) && size(std::abs(body.gravity.x)) &&
         size(std::abs(body.gravity.y)) && size(std::abs(body.gravity.z)) && size(body.coupling) && body.coupling > 0 &&
         size(body.friction);
}

bool are_materials(const ElasticBody& body) noexcept {
  const auto size = [](double v) { return v > 0 && v <= ElasticBody::kLargest; };
  return !body.materials.empty() && body.materials.size() <= ElasticBody::kMaxMaterials &&
         std::ranges::all_of(body.materials, [&](const ElasticMaterial& m) {
           return size(m.young) && size(m.density) && m.poisson > -1 && m.poisson <= ElasticBody::kMostPoisson;
         });
}

bool is_tet(const ElasticBody::Tet& tet, std::size_t vertices) noexcept {
  for (std::size_t i = 0; i < 4; ++i)
    if (tet[i] >= vertices || std::ranges::count(tet, tet[i]) > 1) return false;
  return true;
}

bool are_tets(const DeformableObject& object) noexcept {
  const ElasticBody& body = *object.body;
  const std::size_t vertices = object.rest.size() + body.inner.size();
  return vertices <= kMaxMeshVertices && !body.tets.empty() && body.tets.size() <= kMaxMeshTriangles &&
         body.material.size() == body.tets.size() &&
         std::ranges::all_of(body.tets, [&](const ElasticBody::Tet& tet) { return is_tet(tet, vertices); }) &&
         std::ranges::all_of(body.material, [&](std::uint8_t m) { return m < body.materials.size(); }) &&
         are_runs(body.fixed, vertices);
}

double read_number(ByteReader& in) noexcept { return std::bit_cast<double>(in.u64()); }
void write_number(ByteWriter& out, double v) { out.u64(std::bit_cast<std::uint64_t>(v)); }

Result<void> parse_constants(ByteReader& in, ElasticBody& body) {
  for (double* v : {&body.mass_damping, &body.stiffness_damping, &body.gravity.x, &body.gravity.y, &body.gravity.z,
                    &body.coupling, &body.friction})
    *v = read_number(in);
  body.materials.resize(in.u8());
  for (ElasticMaterial& m : body.materials)
    for (double* v : {&m.young, &m.poisson, &m.density}) *v = read_number(in);
  if (!in.ok()) return fail(Errc::truncated, "R-STR-5", in.bit_offset());
  if (!are_constants(body) || !are_materials(body)) return fail(Errc::invalid, "R-ELA-2", in.bit_offset());
  return {};
}

/// First corner as a difference from the first corner before, the others from the corner before.
Result<void> parse_tets(ByteReader& in, std::uint64_t count, std::size_t vertices, ElasticBody& body) {
  body.tets.reserve(static_cast<std::size_t>(count));
  std::uint32_t first = 0;
  for (std::uint64_t t = 0; t < count; ++t) {
    ElasticBody::Tet tet{};
    std::int64_t last = first;
    for (std::uint32_t& corner : tet) {
      constexpr std::uint64_t kFarthest = 4 * kMaxMeshVertices;  // leads to no vertex, nor do the differences after it
      last += unzigzag(std::min(in.varint(), kFarthest));
      corner = last < 0 || last >= std::int64_t{kMaxMeshVertices} ? kNoVertex : static_cast<std::uint32_t>(last);
    }
    if (!in.ok()) return fail(class_of_overflow(in), "R-STR-5", in.bit_offset());
    if (!is_tet(tet, vertices)) return fail(Errc::invalid, "R-ELA-3", in.bit_offset());
    body.tets.push_back(tet);
    first = tet[0];
  }
  return {};
}

/// Runs of tetrahedra of one material, where there are several.
Result<void> parse_material_runs(ByteReader& in, ElasticBody& body) {
  body.material.assign(body.tets.size(), 0);
  for (std::uint64_t begin = 0; body.materials.size() > 1 && begin < body.tets.size();) {
    const std::uint64_t length = in.varint();
    const std::uint8_t material = in.u8();
    if (!in.ok()) return fail(class_of_overflow(in), "R-STR-5", in.bit_offset());
    if (length < 1 || length > body.tets.size() - begin || material >= body.materials.size())
      return fail(Errc::invalid, "R-ELA-3", in.bit_offset());
    std::fill_n(body.material.begin() + static_cast<std::ptrdiff_t>(begin), length, material);
    begin += length;
  }
  return {};
}

Result<void> parse_body(ByteReader& in, ElasticBody::Method method, DeformableObject& object) {
  ElasticBody& body = object.body.emplace();
  body.method = method;
  if (method == ElasticBody::Method::velocity_verlet) body.sub_steps = in.u8();
  if (!in.ok()) return fail(Errc::truncated, "R-STR-5", in.bit_offset());
  if (!are_sub_steps(body)) return fail(Errc::invalid, "R-ELA-5", in.bit_offset());
  TACTUS_CHECK(parse_constants(in, body));
  const std::uint64_t inner = in.varint(), tets = in.varint();
  if (!in.ok()) return fail(class_of_overflow(in), "R-STR-5", in.bit_offset());
  if (inner > kMaxMeshVertices - object.rest.size() || tets < 1 || tets > kMaxMeshTriangles)
    return fail(Errc::invalid, "R-ELA-3", in.bit_offset());
  if (3 * inner + 4 * tets > in.remaining()) return fail(Errc::truncated, "R-STR-5", in.bit_offset());
  TACTUS_CHECK(parse_positions(in, inner, body.inner));
  const std::size_t vertices = object.rest.size() + body.inner.size();
  TACTUS_CHECK(parse_tets(in, tets, vertices, body));
  TACTUS_CHECK(parse_material_runs(in, body));
  TACTUS_TRY(body.fixed, parse_runs(in, vertices, "R-ELA-3"));
  return {};
}

void write_body(ByteWriter& out, const ElasticBody& body) {
  if (body.method == ElasticBody::Method::velocity_verlet) out.u8(body.sub_steps);
  for (const double v :
       {body.mass_damping, body.stiffness_damping, body.gravity.x, body.gravity.y, body.gravity.z, body.coupling, body.friction})
    write_number(out, v);
  out.u8(static_cast<std::uint8_t>(body.materials.size()));
  for (const ElasticMaterial& m : body.materials)
    for (const double v : {m.young, m.poisson, m.density}) write_number(out, v);
  out.varint(body.inner.size());
  out.varint(body.tets.size());
  write_positions(out, body.inner);
  std::uint32_t first = 0;
  for (const ElasticBody::Tet& tet : body.tets) {
    std::uint32_t last = first;
    for (const std::uint32_t corner : tet) {
      out.varint(zigzag(std::int64_t{corner} - last));
      last = corner;
    }
    first = tet[0];
  }
  for (std::size_t i = 0; body.materials.size() > 1 && i < body.material.size();) {
    std::size_t end = i;
    while (end < body.material.size() && body.material[end] == body.material[i]) ++end;
    out.varint(end - i);
    out.u8(body.material[i]);
    i = end;
  }
  write_runs(out, body.fixed);
}

}  // namespace

bool has_elastic_body(std::span<const DeformableObject> objects) noexcept {
  return std::ranges::any_of(objects, [](const DeformableObject& object) { return object.body.has_value(); });
}

RuleName broken_elastic_rule(const DeformableObject& object) noexcept {
  if (!object.body) return {};
  const auto method = static_cast<std::uint8_t>(object.body->method);
  if (!can_have_body(object) || method < 1 || method > kMostMethod) return "R-ELA-1";
  if (!are_sub_steps(*object.body)) return "R-ELA-5";
  if (!are_constants(*object.body) || !are_materials(*object.body)) return "R-ELA-2";
  if (!are_tets(object)) return "R-ELA-3";
  return {};
}

bool is_solid(const DeformableObject& object, unsigned position_exp) {
  const ElasticBody& body = *object.body;
  const double unit = std::ldexp(1.0, -static_cast<int>(position_exp));
  const auto at = [&](std::uint32_t v) {
    const Vec3i& p = v < object.rest.size() ? object.rest[v] : body.inner[v - object.rest.size()];
    return Vec3{unit * p[0], unit * p[1], unit * p[2]};
  };
  std::vector<std::uint8_t> is_held(object.rest.size() + body.inner.size(), 0);
  for (const std::uint32_t v : body.fixed) is_held[v] = 1;
  if (std::ranges::find(is_held, 0) == is_held.end()) return false;
  for (const ElasticBody::Tet& t : body.tets) {
    const Vec3 origin = at(t[0]), x = at(t[1]) - origin, y = at(t[2]) - origin, z = at(t[3]) - origin;
    if (!(dot(cross(x, y), z) > 0)) return false;
    for (const std::uint32_t v : t) is_held[v] = 1;
  }
  return std::ranges::find(is_held, 0) == is_held.end();
}

bool steps_stably(const DeformableObject& object, unsigned position_exp, std::uint32_t tick_rate) {
  if (object.body->method != ElasticBody::Method::velocity_verlet) return true;
  const std::uint32_t ticks = object.frame_period / 256;
  const double step = static_cast<double>(ticks) / tick_rate;
  return is_stable(*object.body, elastic_rest(object, position_exp), step);
}

void write_elastic(ByteWriter& out, std::span<const DeformableObject> objects) {
  for (const DeformableObject& object : objects) {
    out.u8(object.body ? static_cast<std::uint8_t>(object.body->method) : 0);
    if (object.body) write_body(out, *object.body);
  }
}

Result<void> parse_elastic(ByteReader& in, std::span<DeformableObject> objects, unsigned position_exp) {
  for (DeformableObject& object : objects) {
    const std::uint8_t method = in.u8();
    if (!in.ok()) return fail(Errc::truncated, "R-STR-5", in.bit_offset());
    if (method > kMostMethod) return fail(Errc::malformed, "R-ELA-1", in.bit_offset());
    if (method == 0) continue;
    if (!can_have_body(object)) return fail(Errc::invalid, "R-ELA-1", in.bit_offset());
    TACTUS_CHECK(parse_body(in, static_cast<ElasticBody::Method>(method), object));
    if (!is_solid(object, position_exp)) return fail(Errc::invalid, "R-ELA-4", in.bit_offset());
  }
  if (!has_elastic_body(objects)) return fail(Errc::invalid, "R-ELA-1", in.bit_offset());
  return {};
}

}  // namespace tactus
