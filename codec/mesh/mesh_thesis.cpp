// SPDX-License-Identifier: Apache-2.0
#include "codec/mesh/mesh_thesis.h"

namespace tactus {

std::vector<BitModel> cold_thesis_models(const MeshObject& mesh) {
  return std::vector<BitModel>(kIndexModels + (std::size_t{1} << mesh.quant_bits) - 1);
}

}  // namespace tactus
