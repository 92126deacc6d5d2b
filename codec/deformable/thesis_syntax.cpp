// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/thesis_syntax.h>

namespace tactus {

std::vector<BitModel> initial_thesis_models(const DeformableObject& mesh) {
  return std::vector<BitModel>(kIndexModels + (std::size_t{1} << mesh.quant_bits) - 1);
}

}  // namespace tactus
