// SPDX-License-Identifier: Apache-2.0
/// The constraint planes of a virtual proxy, and its goal among them (thesis 2.3.4.1): one plane on a face, two in a groove,
/// three in a corner.
///
///   minimise |x - goal|  with  n_i . x >= o_i        x = goal + sum lambda_i n_i,  lambda_i >= 0
/// lambda_i [m] is the part of the probe's depth that plane i resists; times the stiffness, it is the force of that plane.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include <tactus/base/geometry.h>

namespace tactus::sim {

/// n . x >= offset, n of unit length
struct Halfspace {
  Vec3 normal;
  double offset = 0;
};

inline constexpr std::size_t kMaxHalfspaces = 6;

struct Constrained {
  Vec3 point;                                   ///< x
  std::array<double, kMaxHalfspaces> lambda{};  ///< per half-space; at most three are not zero
  double sum() const noexcept;                  ///< of lambda
};

/// Nearest point to the goal in the intersection, found by trying sets of active planes.
/// in   planes  at most kMaxHalfspaces
///      slack   [m] tolerated depth below a plane: rounding is no contact
/// out  nothing when rounding hides the answer (nearly parallel planes)
/// time O(1): at most 42 sets of planes are tried; no allocation
std::optional<Constrained> nearest_within(std::span<const Halfspace> planes, const Vec3& goal, double slack) noexcept;

}  // namespace tactus::sim
