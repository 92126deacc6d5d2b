// SPDX-License-Identifier: Apache-2.0
/// The C interface from fuzz targets: handles that destroy themselves, and what every status must come with.
#pragma once

#include <tactus.h>

#include <cstdint>
#include <memory>
#include <string_view>

#include "tests/fuzz/require.h"

namespace tactus::c_fuzz {

template <auto destroy>
struct Destroy {
  void operator()(auto* handle) const { destroy(handle); }
};
using Scene = std::unique_ptr<tactus_scene, Destroy<tactus_scene_destroy>>;
using Builder = std::unique_ptr<tactus_scene_builder, Destroy<tactus_scene_builder_destroy>>;
using Sender = std::unique_ptr<tactus_sender, Destroy<tactus_sender_destroy>>;
using Receiver = std::unique_ptr<tactus_receiver, Destroy<tactus_receiver_destroy>>;
using Player = std::unique_ptr<tactus_player, Destroy<tactus_player_destroy>>;
using Writer = std::unique_ptr<tactus_writer, Destroy<tactus_writer_destroy>>;

template <class T>
T sized() {
  T out{};
  out.size = sizeof(T);
  return out;
}
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
