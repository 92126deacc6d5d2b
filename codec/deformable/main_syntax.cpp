// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/main_syntax.h>

namespace tactus {

namespace {

constexpr BitModel kRows[] = {
#include "deformable_start_models.inc"
};
static_assert(sizeof kRows == sizeof(MainModels), "spec/tables/deformable-start-models.csv has one row per model");

}  // namespace

const MainModels& main_start_models() noexcept {
  static constexpr MainModels models = std::bit_cast<MainModels>(std::to_array(kRows));
  return models;
}

}  // namespace tactus
