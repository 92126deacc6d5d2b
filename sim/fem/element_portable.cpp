// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/element_kernel.h>

namespace tactus::sim {

ElementKernels portable_kernels() noexcept { return Kernel<2>::kKernels; }

}  // namespace tactus::sim
