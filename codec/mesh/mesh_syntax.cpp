// SPDX-License-Identifier: Apache-2.0
#include "codec/mesh/mesh_syntax.h"

namespace tactus {

namespace {

constexpr BitModel kRows[] = {
#include "mesh_start_models.inc"
};
static_assert(sizeof kRows == sizeof(MeshModels), "spec/tables/mesh-start-models.csv has one row per model");

}  // namespace

const MeshModels& mesh_start_models() noexcept {
  static constexpr MeshModels models = std::bit_cast<MeshModels>(std::to_array(kRows));
  return models;
}

}  // namespace tactus
