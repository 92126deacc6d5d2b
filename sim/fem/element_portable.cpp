// SPDX-License-Identifier: Apache-2.0
#include "sim/fem/element_kernel.h"

namespace tactus {

const ElementKernels kPortableKernels = Kernel<2>::kKernels;

}  // namespace tactus
