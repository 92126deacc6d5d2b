// SPDX-License-Identifier: Apache-2.0
#include <tactus/mesh/deformable_object.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <tactus/base/fixed.h>
#include <tactus/base/quantise.h>
#include <tactus/base/rule.h>

namespace tactus {

namespace {

bool has_areas(const DeformableObject& object) noexcept {
  return std::ranges::all_of(object.triangles, [&](const Triangle& t) {
    if (std::ranges::any_of(t, [&](std::uint32_t v) { return v >= object.rest.size(); })) return true;  // R-DEF-6 of the scene
    const auto corner = [&](std::size_t k) {
      const auto& p = object.rest[t[k]];
      return Vec3{static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
    };
    return norm(cross(corner(1) - corner(0), corner(2) - corner(0))) > 0;
  });
}

constexpr double kLevelsPerOctave = 10, kFirstOctave = -6;  // of stiffness in N/m

}  // namespace

Result<std::uint8_t> stiffness_level(double stiffness) noexcept {
  if (!(stiffness > 0)) return fail(Errc::invalid_argument, "R-API-4");
  if (std::isinf(stiffness)) return std::uint8_t{0};
  const double level = std::floor(kLevelsPerOctave * (std::log2(stiffness) - kFirstOctave) + 0.5) + 1;
  return static_cast<std::uint8_t>(std::clamp(level, 1.0, 255.0));
}

double stiffness_of_level(std::uint8_t level) noexcept {
  if (level == 0) return std::numeric_limits<double>::infinity();
  return std::exp2((level - 1) / kLevelsPerOctave + kFirstOctave);
}

double stiffness_at(const DeformableObject& object, std::uint32_t triangle, const std::array<double, 3>& weights) noexcept {
  double sum = 0;
  for (std::size_t k = 0; k < weights.size(); ++k)
    if (weights[k] != 0) sum += weights[k] * stiffness_of_level(object.stiffness[object.triangles[triangle][k]]);
  return sum;
}

void append_mode(ModeBasis& basis, std::span<const double> vector, double coarseness) {
  double largest = 0, square = 0;
  for (const double c : vector) largest = std::max(largest, std::abs(c));
  if (largest == 0) largest = 1;
  for (const double c : vector) {
    basis.entries.push_back(static_cast<std::int16_t>(std::floor(c / largest * ModeBasis::kMaxEntry + 0.5)));
    square += (c / largest) * (c / largest);
  }
  const double step = coarseness / std::sqrt(std::max(square, 1.0)) * 4096 * 2048 / ModeBasis::kMaxEntry;
  basis.steps.push_back(static_cast<std::uint16_t>(std::clamp(std::floor(step + 0.5), 1.0, 65535.0)));
}

Result<ModeBasis> make_mode_basis(std::span<const double> vectors, std::size_t modes, double coarseness) try {
  if (modes > ModeBasis::kMaxModes || modes == 0 || vectors.size() % (3 * modes) != 0)
    return fail(Errc::invalid_argument, "R-API-9");
  const std::size_t components = vectors.size() / modes;
  ModeBasis out;
  out.entries.reserve(vectors.size());
  for (std::size_t k = 0; k < modes; ++k) {
    const auto mode = vectors.subspan(k * components, components);
    const auto is_finite = [](double c) { return std::isfinite(c); };
    const auto is_zero = [](double c) { return c == 0; };
    if (!std::ranges::all_of(mode, is_finite) || std::ranges::all_of(mode, is_zero))
      return fail(Errc::invalid_argument, "R-API-1");
    append_mode(out, mode, coarseness);
  }
  return out;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<DeformableObject> make_deformable_object(std::string name, const TriMesh& surface, unsigned position_exp) try {
  DeformableObject out;
  out.name = std::move(name);
  out.triangles = surface.triangles;
  out.rest.resize(surface.vertices.size());
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    const Vec3& p = surface.vertices[v];
    if (!is_finite(p)) return fail(Errc::invalid_argument, "R-API-1");
    constexpr double kLimit = 2147483647.0;
    auto& out_v = out.rest[v];
    if (!quantise(p.x, position_exp, kLimit, out_v[0]) || !quantise(p.y, position_exp, kLimit, out_v[1]) ||
        !quantise(p.z, position_exp, kLimit, out_v[2]))
      return fail(Errc::invalid_argument, "R-API-2");
  }
  if (!has_areas(out)) return fail(Errc::invalid_argument, "R-API-10");
  return out;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

}  // namespace tactus
