// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/displacement.h>

#include <cmath>

#include <tactus/base/rule.h>

namespace tactus {

Result<void> to_grid(std::span<const float> displacements, unsigned position_exp,
                     std::span<std::array<std::int32_t, 3>> out) noexcept {
  if (displacements.size() != 3 * out.size()) return fail(Errc::invalid_argument, "R-API-5");
  constexpr double kLimit = DeformableObject::kMaxDisplacement;
  const double scale = static_cast<double>(std::uint64_t{1} << position_exp);
  const float* u = displacements.data();
  for (auto& vertex : out) {
    for (std::int32_t& component : vertex) {
      const double scaled = std::floor(static_cast<double>(*u) * scale + 0.5);
      if (!(scaled >= -kLimit && scaled <= kLimit))
        return fail(Errc::invalid_argument, std::isfinite(*u) ? RuleName("R-API-2") : RuleName("R-API-1"));
      component = static_cast<std::int32_t>(scaled);
      ++u;
    }
  }
  return {};
}

}  // namespace tactus
