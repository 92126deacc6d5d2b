// SPDX-License-Identifier: Apache-2.0
/// The C interface from fuzz targets: what every status must come with.
#pragma once

#include <cstdint>
#include <string_view>

#include "tests/bindings/handles.h"
#include "tests/fuzz/require.h"

namespace tactus::c_fuzz {

using namespace c_test;

template <class T>
T filled() {
  T out;
  require(init<T>(&out, sizeof out) == TACTUS_OK);
  return out;
}

/// Calls a function whose last argument is the error: every failure has a name, a rule, a text and an advice, and is no defect.
/// out  it is done; else nothing was there, or it was refused
template <class Function, class... Arguments>
bool call(Function function, Arguments... arguments) {
  tactus_error error{};
  const tactus_status status = function(arguments..., &error);
  require(status != TACTUS_INTERNAL);
  if (status == TACTUS_OK || status == TACTUS_NOTHING) {
    require(error.rule == nullptr);
    return status == TACTUS_OK;
  }
  require(error.status == status && std::string_view(error.name) != "unknown" && error.rule[0] == 'R' && *error.text != 0);
  require(error.remedy != nullptr && error.object != nullptr && error.detail != nullptr);
  require(error.advice >= TACTUS_ADVICE_NONE && error.advice <= TACTUS_ADVICE_CLOSE);
  return false;
}

}  // namespace tactus::c_fuzz
