// SPDX-License-Identifier: Apache-2.0
/// Dense inner loops of the Cholesky solver, compiled for several instruction sets. No contraction, four partial sums whatever the
/// width: the same bits with each of them. Matrices are stored column by column.
#pragma once

namespace tactus {

/// y += a x.
void panel_axpy(double a, const double* x, double* y, int rows) noexcept;
/// y = L x.   in  L  rows x width, columns `stride` apart
void panel_times(const double* L, int stride, int rows, int width, const double* x, double* y) noexcept;
/// x -= L^T y.   in  L  rows x width, columns `rows` apart   pre  rows is a multiple of 4
void panel_transposed_times(const double* L, int rows, int width, const double* y, double* x) noexcept;
/// x = T^-1 x and x = T^-T x.   in  T  lower triangle, width x width
void lower_solve(const double* T, int width, double* x) noexcept;
void upper_solve(const double* T, int width, double* x) noexcept;

}  // namespace tactus
