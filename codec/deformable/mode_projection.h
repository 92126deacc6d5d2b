// SPDX-License-Identifier: Apache-2.0
/// Encoder side: the combination of modes nearest to an error field. Informative; floating point in a fixed order.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/fixed.h>
#include <tactus/scene/deformable_object.h>

namespace tactus {

class ModeProjection {
 public:
  /// Inverts the modes' Gram matrix, so that they need not be orthogonal.
  /// pre  `basis` outlives the projection
  /// time O(modes^2 vertices), with clusters O(vertices + clusters^3)
  explicit ModeProjection(const ModeBasis& basis);

  /// Coefficients of least squared error [grid units at a mode's entry of 1].
  /// time O(modes * vertices), with clusters O(vertices + clusters^2); no allocation
  void project(std::span<const Vec3i> error, std::span<float> coefficients) noexcept;
  /// Of the entries: lower triangle, modes x modes; empty for clusters.
  std::span<const double> gram() const noexcept { return gram_; }

 private:
  void invert_entries();
  void factorise_shares();
  void project_on_shares(std::span<const Vec3i> error, std::span<float> coefficients) noexcept;

  const ModeBasis& basis_;
  std::vector<double> gram_;
  std::vector<float> dual_;  // modes x components
  std::vector<float> error_;
  std::vector<double> factor_;              // of clusters: of the Gram matrix of their functions, alike for every axis
  std::array<std::vector<double>, 3> sum_;  // by axis and function
};

}  // namespace tactus
