// SPDX-License-Identifier: Apache-2.0
/// The C interface from fuzz targets: what every status must come with.
#pragma once

#include <cstdint>
#include <string_view>

#include "tests/bindings/handles.h"
#include "tests/fuzz/require.h"

namespace tactus::c_fuzz {

using namespace c_test;

template <auto init, class T>
T filled() {
  T out;
  require(init(&out, sizeof out) == TACTUS_OK);
  return out;
}

/// Calls a function whose last argument is the error: every failure has a name, a rule, a text and an advice, and is no defect.
/// out  it is done; else nothing was there, or it was refused
template <class Function, class... Arguments>
bool call(Function function, Arguments... arguments) {
  tactus_error error{};
  const tactus_status status = function(arguments..., &error);
  require(std::string_view(tactus_status_name(status)) != "unknown" && status != TACTUS_INTERNAL);
  if (status == TACTUS_OK || status == TACTUS_NOTHING) {
    require(error.rule == nullptr);
    return status == TACTUS_OK;
  }
  require(error.status == status && error.rule[0] == 'R' && *tactus_error_text(&error) != 0 &&
          tactus_error_remedy(&error) != nullptr);
  require(tactus_error_advice(&error) >= TACTUS_ADVICE_NONE && tactus_error_advice(&error) <= TACTUS_ADVICE_CLOSE);
  return false;
}

}  // namespace tactus::c_fuzz
