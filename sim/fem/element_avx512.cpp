// SPDX-License-Identifier: Apache-2.0
#include "sim/fem/element_kernel.h"

namespace tactus {

const ElementKernels kAvx512Kernels = Kernel<8>::kKernels;

}  // namespace tactus
