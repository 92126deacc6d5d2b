// SPDX-License-Identifier: Apache-2.0
/// The planes that hold a virtual proxy, and where it wants to be among them (thesis 2.3.4.1): one plane on a face, two in a groove,
/// three in a corner.
///
///   minimise |x - goal|  with  n_i . x >= o_i        x = goal + sum lambda_i n_i,  lambda_i >= 0
/// lambda_i [m] is how deep the probe lies below what plane i alone makes of it: times the stiffness, the force of that plane.
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

/// Nearest point to the goal in the intersection, by trying which planes hold it.
/// in   planes  at most kMaxHalfspaces
///      slack   [m] by so much a plane may be overstepped: rounding is no contact
/// out  nothing when rounding hides the answer (planes that are parallel but for rounding)
/// time O(1): at most 42 sets of planes are tried; no allocation
std::optional<Constrained> nearest_within(std::span<const Halfspace> planes, const Vec3& goal, double slack) noexcept;

}  // namespace tactus::sim
