// SPDX-License-Identifier: Apache-2.0
/// Assembles 12 x 12 element matrices into a sparse matrix of known pattern. Inside of FemModel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <tactus/sim/fem/element.h>
#include <tactus/sim/fem/model.h>

namespace tactus::sim {

/// Sixteen 3 x 3 blocks, (a, b) at 4 a + b, rows first.
using ElementMatrix = std::array<Matrix3, 16>;

/// K_e turned by R [N/m]: block (a, b) = V (lambda h_a h_b^T + mu h_b h_a^T + mu h_a . h_b I), h = R g.
ElementMatrix rotated_stiffness(const Elements& elements, std::size_t element, bool corotated) noexcept;

/// dk/dx [N/m] at F: with w = axial(R^T dF), G = tr(S) I - S, S = sym(R^T F), the second derivative of W along dF is
///   V (2 mu |dF|^2 + lambda (R : dF)^2 - c w^T G^-1 w),   c = 2 mu - lambda (tr(S) - 3)
/// since dR = R [G^-1 w]. Its part in the skew modes of R^T dF, mu - c / gamma for each eigenvalue gamma of G, turns negative
/// under compression and infinite where two signed singular values sum to zero; it is kept within [0, 64 mu].
ElementMatrix tangent(const Elements& elements, std::size_t element, const double* u) noexcept;

class Assembly {
 public:
  Assembly() = default;
  /// free_vertex[v]: number of vertex v among the free ones, -1 when it is fixed.
  Assembly(const Elements& elements, std::span<const int> free_vertex, int free_count);

  /// Give `sum` the pattern, values zero. Allocates unless it has the pattern already.
  void prepare(SparseMatrix& sum) const;
  /// pre  prepare(sum)
  void add(std::size_t element, const ElementMatrix& matrix, SparseMatrix& sum) const noexcept;

 private:
  struct Slot {
    std::int32_t first = -1;  ///< where the block's first row begins among the values; -1: a corner is fixed
    std::int32_t stride = 0;  ///< from one of its rows to the next
  };
  SparseMatrix pattern_;
  std::vector<std::array<Slot, 16>> slots_;
};

}  // namespace tactus::sim
