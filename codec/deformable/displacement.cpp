// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/displacement.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <tactus/base/out_of_memory.h>

namespace tactus {
namespace {

/// floor(v * 2^exp + 1/2), or false when it is not within +-limit.
bool quantise(const Vec3& v, unsigned exp, double limit, std::array<std::int32_t, 3>& out) noexcept {
  const double scale = static_cast<double>(std::uint64_t{1} << exp);
  const double scaled[] = {std::floor(v.x * scale + 0.5), std::floor(v.y * scale + 0.5), std::floor(v.z * scale + 0.5)};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(scaled[i] >= -limit && scaled[i] <= limit)) return false;
    out[i] = static_cast<std::int32_t>(scaled[i]);
  }
  return true;
}

}  // namespace

Result<DeformableObject> make_deformable_object(std::string name, const TriMesh& mesh, unsigned position_exp) try {
  DeformableObject out;
  out.name = std::move(name);
  out.triangles = mesh.triangles;
  out.rest.resize(mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!is_finite(mesh.vertices[v])) return fail(Errc::invalid_argument, "R-API-1");
    if (!quantise(mesh.vertices[v], position_exp, 2147483647.0, out.rest[v])) return fail(Errc::invalid_argument, "R-API-2");
  }
  return out;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<ModeBasis> make_mode_basis(std::span<const double> vectors, std::size_t modes, double coarseness) try {
  if (modes > ModeBasis::kMaxModes || modes == 0 || vectors.size() % (3 * modes) != 0)
    return fail(Errc::invalid_argument, "R-API-9");
  const std::size_t components = vectors.size() / modes;
  ModeBasis out;
  out.entries.reserve(vectors.size());
  for (std::size_t k = 0; k < modes; ++k) {
    const auto mode = vectors.subspan(k * components, components);
    double largest = 0, square = 0;
    for (const double c : mode) {
      if (!std::isfinite(c)) return fail(Errc::invalid_argument, "R-API-1");
      largest = std::max(largest, std::abs(c));
    }
    if (!(largest > 0)) return fail(Errc::invalid_argument, "R-API-1");
    for (const double c : mode) {
      out.entries.push_back(static_cast<std::int16_t>(std::floor(c / largest * ModeBasis::kMaxEntry + 0.5)));
      square += (c / largest) * (c / largest);
    }
    const double step = coarseness / std::sqrt(square) * 4096 * 2048 / ModeBasis::kMaxEntry;
    out.steps.push_back(static_cast<std::uint16_t>(std::clamp(std::floor(step + 0.5), 1.0, 65535.0)));
  }
  return out;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<void> to_grid(std::span<const Vec3> displacement, unsigned position_exp,
                     std::span<std::array<std::int32_t, 3>> out) noexcept {
  if (displacement.size() != out.size()) return fail(Errc::invalid_argument, "R-API-5");
  for (std::size_t v = 0; v < out.size(); ++v) {
    if (quantise(displacement[v], position_exp, DeformableObject::kMaxDisplacement, out[v])) continue;
    return fail(Errc::invalid_argument, is_finite(displacement[v]) ? "R-API-2" : "R-API-1");
  }
  return {};
}

Vec3 to_metres(const std::array<std::int32_t, 3>& v, unsigned position_exp) noexcept {
  const double unit = 1.0 / static_cast<double>(std::uint64_t{1} << position_exp);
  return {v[0] * unit, v[1] * unit, v[2] * unit};
}

}  // namespace tactus
