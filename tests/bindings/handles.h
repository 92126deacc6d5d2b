// SPDX-License-Identifier: Apache-2.0
/// Objects of the C interface that destroy themselves, and structs that know their size.
#pragma once

#include <tactus_encoder.h>

#include <memory>

namespace tactus::c_test {

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

}  // namespace tactus::c_test
