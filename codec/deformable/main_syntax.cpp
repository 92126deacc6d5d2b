// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/main_syntax.h>

namespace tactus {

namespace {

constexpr StartModel<5> kRows[] = {
#include "deformable_start_models.inc"
};

}  // namespace

const MainModels& main_start_models() noexcept {
  static const MainModels models = unpack<MainModels>(kRows);
  return models;
}

}  // namespace tactus
