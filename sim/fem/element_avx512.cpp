// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/element_kernel.h>

namespace tactus::sim {

ElementKernels avx512_kernels() noexcept { return Kernel<8>::kKernels; }

}  // namespace tactus::sim
