// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/element_kernel.h>

namespace tactus::sim {

ElementKernels avx2_kernels() noexcept { return Kernel<4>::kKernels; }

}  // namespace tactus::sim
