// SPDX-License-Identifier: Apache-2.0
#include "sim/fem/element_kernel.h"

namespace tactus {

const ElementKernels kAvx2Kernels = Kernel<4>::kKernels;

}  // namespace tactus
