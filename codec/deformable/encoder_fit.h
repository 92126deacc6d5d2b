// SPDX-License-Identifier: Apache-2.0
/// Fits of a basis to a shape, over all vertices or inside the area of interest: an encoder's choices. Internal to the library.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/fixed.h>
#include <tactus/scene/scene_objects.h>

namespace tactus {

// ==== mode projection ====
// Encoder side: the combination of modes nearest to an error field. Informative; floating point in a fixed order.

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
  void factorise_clusters();
  void project_on_clusters(std::span<const Vec3i> error, std::span<float> coefficients) noexcept;

  const ModeBasis& basis_;
  std::vector<double> gram_;
  std::vector<float> dual_;  // modes x components
  std::vector<float> error_;
  std::vector<double> factor_;              // of clusters: of the Gram matrix of their functions, alike for every axis
  std::array<std::vector<double>, 3> sum_;  // by axis and function
};

// ==== area fit ====
// Encoder side: coefficients of modes that fit the area of interest better, where the bound is smaller. Informative; floating point in a
// fixed order.

/// The area of interest and the bounds [grid units].
struct BoundedArea {
  std::span<const std::uint32_t> vertices;
  float inside = 0, outside = 0;
};

/// Least squares in which an error e in the area counts outside^2 / (inside^2 + |e|^2) times one elsewhere, at least once and at most 64
/// times: what the plain fit leaves far from its bound needs a residual anyhow.
class AreaFit {
 public:
  /// in   gram  lower triangle of the entries' Gram matrix, modes x modes, of ModeProjection; none if the basis has clusters
  /// pre  `basis` outlives the fit
  AreaFit(const ModeBasis& basis, std::span<const double> gram);

  /// Moves the coefficients of the plain fit to those of the weighted one, by a few steps of conjugate gradients. Of more than 64
  /// vertices the first count. Nothing for clusters, or where the bound inside is not smaller.
  /// in   error  by vertex, as ModeProjection::project() had it [grid units]
  /// time O(modes (vertices weighed + modes)), 20 us with 48 modes and 37 vertices; no allocation
  void improve(std::span<const Vec3i> error, const BoundedArea& area, std::span<float> coefficients) noexcept;

 private:
  static constexpr std::size_t kMostVertices = 64;  // so that a large area costs no more than a small one

  void read_area(std::span<const Vec3i> error, const BoundedArea& area) noexcept;
  void find_image() noexcept;
  float measure_gradient() noexcept;

  const ModeBasis& basis_;
  std::size_t modes_;                        // with zeros up to whole lanes, as are all vectors over modes
  std::vector<float> gram_;                  // with its ridge; empty for clusters
  std::vector<float> scale_;                 // 1 / its diagonal
  std::vector<float> rows_;                  // of the area: entries by vertex, axis and mode
  std::array<float, kMostVertices> more_{};  // weights less 1
  std::size_t weighed_ = 0;                  // vertices in both
  std::vector<float> start_, change_;        // coefficients
  std::vector<float> gradient_, scaled_, direction_, image_;
};

}  // namespace tactus
