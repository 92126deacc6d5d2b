// SPDX-License-Identifier: Apache-2.0
#include "sim/fem/panel_kernels.h"

#include <cstddef>

// Thread sanitizer runs before a resolver could ask what the processor has.
#if defined(__x86_64__) && defined(__ELF__) && !defined(__SANITIZE_THREAD__)
#define TACTUS_WIDE [[gnu::target_clones("avx512f", "avx2", "default")]]
#else
#define TACTUS_WIDE
#endif

namespace tactus {
namespace {

using Four [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = double;

std::ptrdiff_t far(int stride, int column) { return static_cast<std::ptrdiff_t>(stride) * column; }

}  // namespace

TACTUS_WIDE void panel_axpy(double a, const double* x, double* y, int rows) noexcept {
  for (int i = 0; i < rows; ++i) y[i] += a * x[i];
}

TACTUS_WIDE void panel_times(const double* L, int stride, int rows, int width, const double* x, double* y) noexcept {
  int j = width % 3;
  for (int i = 0; i < rows; ++i) y[i] = 0;
  for (int k = 0; k < j; ++k) {
    const double* c = L + far(stride, k);
    for (int i = 0; i < rows; ++i) y[i] += c[i] * x[k];
  }
  for (; j < width; j += 3) {
    const double *c0 = L + far(stride, j), *c1 = c0 + stride, *c2 = c1 + stride;
    const double x0 = x[j], x1 = x[j + 1], x2 = x[j + 2];
    for (int i = 0; i < rows; ++i) y[i] += c0[i] * x0 + c1[i] * x1 + c2[i] * x2;
  }
}

TACTUS_WIDE void panel_transposed_times(const double* L, int rows, int width, const double* y, double* x) noexcept {
  for (int j = 0; j + 3 <= width; j += 3) {
    const double *c0 = L + far(rows, j), *c1 = c0 + rows, *c2 = c1 + rows;
    Four s0{}, s1{}, s2{};
    for (int i = 0; i < rows; i += 4) {
      const Four here = *reinterpret_cast<const Four*>(y + i);
      s0 += *reinterpret_cast<const Four*>(c0 + i) * here;
      s1 += *reinterpret_cast<const Four*>(c1 + i) * here;
      s2 += *reinterpret_cast<const Four*>(c2 + i) * here;
    }
    x[j] -= (s0[0] + s0[1]) + (s0[2] + s0[3]);
    x[j + 1] -= (s1[0] + s1[1]) + (s1[2] + s1[3]);
    x[j + 2] -= (s2[0] + s2[1]) + (s2[2] + s2[3]);
  }
}

TACTUS_WIDE void lower_solve(const double* T, int width, double* x) noexcept {
  for (int j = 0; j < width; ++j) {
    const double* column = T + far(width, j);
    const double here = x[j] /= column[j];
    for (int i = j + 1; i < width; ++i) x[i] -= column[i] * here;
  }
}

TACTUS_WIDE void upper_solve(const double* T, int width, double* x) noexcept {
  for (int j = width - 1; j >= 0; --j) {
    const double* column = T + far(width, j);
    int i = j + 1;
    Four sum{};
    for (; i + 4 <= width; i += 4) sum += *reinterpret_cast<const Four*>(column + i) * *reinterpret_cast<const Four*>(x + i);
    double rest = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    for (; i < width; ++i) rest += column[i] * x[i];
    x[j] = (x[j] - rest) / column[j];
  }
}

}  // namespace tactus
