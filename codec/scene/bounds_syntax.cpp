// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/bounds.h>

#include <algorithm>
#include <bit>

#include <tactus/base/rule.h>
#include <tactus/scene/bounds_syntax.h>

namespace tactus {
namespace {

constexpr std::uint8_t kKept = 1;  // bits of `promise`
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
  if (t.haptic == HapticRule::perceptual) t.perceptual_share = coder.number(t.perceptual_share);
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
  const unsigned promise = (mesh.kept ? kKept : 0u) | (t.weber_fraction ? kHaptic : 0u);
  const std::uint8_t told = coder.byte(static_cast<std::uint8_t>(promise), kKept | kHaptic);
  mesh.kept = (told & kKept) != 0;
  t.visual = coder.number(t.visual);
  if (!(told & kHaptic)) {
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

}  // namespace tactus
