// SPDX-License-Identifier: Apache-2.0
/// Encoder side: the combination of modes nearest to an error field. Informative; floating point in a fixed order.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/fixed.h>
#include <tactus/scene/deformable_object.h>

namespace tactus {

class ModeProjection {
 public:
  /// Inverts the modes' Gram matrix, so that they need not be orthogonal.   time O(modes^2 vertices)
  explicit ModeProjection(const ModeBasis& basis);

  /// Coefficients of least squared error [grid units at a mode's entry of 1].   time O(modes * vertices)
  void project(std::span<const Vec3i> error, std::span<float> coefficients) noexcept;

 private:
  std::vector<float> dual_;  // modes x components
  std::vector<float> error_;
};

}  // namespace tactus
