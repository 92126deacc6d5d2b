// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/trace_bounds.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include <tactus/base/text.h>

namespace tactus {
namespace {

constexpr std::array<std::string_view, 5> kRules{"off", "isotropic", "cone", "fixed", "perceptual"};  // index: HapticRule

std::string text_of(double value) {
  std::array<char, 32> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

/// Entries of the metadata. Reading and writing go through the same list.
class Entries {
 public:
  explicit Entries(mcap::TextMap& out) : out_(&out) {}
  explicit Entries(const mcap::TextMap& in) : in_(&in) {}

  void number(const std::string& key, double& value) {
    if (out_) out_->emplace(key, text_of(value));
    else value = parsed<double>(key);
    sound = sound && std::isfinite(value) && value >= 0;
  }
  void byte(const std::string& key, std::uint8_t& value) {
    if (out_) out_->emplace(key, std::to_string(value));
    else value = parsed<std::uint8_t>(key);
  }
  void rule(const std::string& key, HapticRule& rule) {
    if (out_) {
      out_->emplace(key, kRules[static_cast<std::size_t>(rule)]);
      return;
    }
    const auto found = in_->find(key);
    const auto name = found == in_->end() ? kRules.end() : std::ranges::find(kRules, found->second);
    sound = sound && name != kRules.end();
    rule = sound ? static_cast<HapticRule>(name - kRules.begin()) : HapticRule::off;
  }
  /// When reading: whether there is such an entry.
  bool has(const std::string& key) const { return in_->contains(key); }
  bool reads() const noexcept { return in_ != nullptr; }

  bool sound = true;

 private:
  template <class T>
  T parsed(const std::string& key) {
    const auto found = in_->find(key);
    const auto value = found == in_->end() ? std::nullopt : parse_number<T>(found->second);
    sound = sound && value.has_value();
    return value.value_or(T{});
  }

  mcap::TextMap* out_ = nullptr;
  const mcap::TextMap* in_ = nullptr;
};

void pass_rigid(Entries& entries, RigidTriggers& t) {
  entries.number("heartbeat", t.heartbeat);
  entries.number("visual_position", t.visual_position);
  entries.number("visual_rotation", t.visual_rotation);
  entries.rule("haptic", t.haptic);
  const bool is_constant = t.haptic == HapticRule::isotropic || t.haptic == HapticRule::cone;
  if (is_constant) entries.number("weber_fraction", t.weber_fraction);
  if (t.haptic == HapticRule::perceptual) entries.number("perceptual_fraction", t.perceptual_fraction);
  if (is_constant || t.haptic == HapticRule::perceptual) entries.number("force_floor", t.force_floor);
  if (t.haptic == HapticRule::cone) entries.number("cone_angle", t.cone_angle);
  if (t.haptic == HapticRule::fixed) {
    entries.number("fixed_position", t.fixed_position);
    entries.number("fixed_rotation", t.fixed_rotation);
  }
}

void pass_mesh(Entries& entries, const std::string& path, DeformableBounds& mesh, std::uint8_t& rings) {
  DeformableThresholds& t = mesh.thresholds;
  std::uint8_t kept = mesh.kept ? 1 : 0;
  entries.number(path + "visual", t.visual);
  entries.byte(path + "kept", kept);
  entries.byte(path + "rings", rings);
  entries.sound = entries.sound && kept <= 1;
  mesh.kept = kept == 1;
  if (entries.reads()) t.weber_fraction = entries.has(path + "weber_fraction") ? std::optional(0.0) : std::nullopt;
  if (!t.weber_fraction) return;
  entries.number(path + "weber_fraction", *t.weber_fraction);
  entries.number(path + "depth_floor", t.depth_floor);
}

void pass(Entries& entries, TraceBounds& bounds) {
  entries.byte("position_exp", bounds.position_exp);
  if (bounds.stream.rigid) pass_rigid(entries, *bounds.stream.rigid);
  for (std::size_t i = 0; i < bounds.stream.deformables.size(); ++i)
    pass_mesh(entries, "meshes/" + std::to_string(i) + "/", bounds.stream.deformables[i], bounds.rings[i]);
}

}  // namespace

mcap::TextMap entries_of(const TraceBounds& bounds) {
  mcap::TextMap out;
  Entries entries(out);
  TraceBounds copy = bounds;
  pass(entries, copy);
  return out;
}

std::optional<TraceBounds> bounds_from(const mcap::TextMap& entries, const TraceInfo& info) {
  TraceBounds bounds;
  if (entries.contains("heartbeat")) bounds.stream.rigid.emplace();
  bounds.stream.deformables.resize(info.meshes.size());
  bounds.rings.resize(info.meshes.size());
  Entries in(entries);
  pass(in, bounds);
  const bool fits = bounds.position_exp <= 30 &&
                    std::ranges::all_of(bounds.rings, [](std::uint8_t r) { return r <= DeformableObject::kMaxRings; });
  return in.sound && fits ? std::optional(std::move(bounds)) : std::nullopt;
}

}  // namespace tactus
