// SPDX-License-Identifier: Apache-2.0
/// Objects of the C interface that destroy themselves, and structs that know their size.
#pragma once

#include <tactus_session.h>

#include <cstdint>
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

/// Which struct with defaults this is, for tactus_init().
template <class T>
inline constexpr std::int32_t kKind = 0;
template <>
inline constexpr std::int32_t kKind<tactus_rigid_bounds> = TACTUS_RIGID_BOUNDS;
template <>
inline constexpr std::int32_t kKind<tactus_deformable_bounds> = TACTUS_DEFORMABLE_BOUNDS;
template <>
inline constexpr std::int32_t kKind<tactus_load_bounds> = TACTUS_LOAD_BOUNDS;
template <>
inline constexpr std::int32_t kKind<tactus_limits> = TACTUS_LIMITS;
template <>
inline constexpr std::int32_t kKind<tactus_receiver_options> = TACTUS_RECEIVER_OPTIONS;
template <>
inline constexpr std::int32_t kKind<tactus_scene_options> = TACTUS_SCENE_OPTIONS;
template <>
inline constexpr std::int32_t kKind<tactus_rigid_options> = TACTUS_RIGID_OPTIONS;
template <>
inline constexpr std::int32_t kKind<tactus_deformable_options> = TACTUS_DEFORMABLE_OPTIONS;
template <>
inline constexpr std::int32_t kKind<tactus_driven_physics> = TACTUS_DRIVEN_PHYSICS;
template <>
inline constexpr std::int32_t kKind<tactus_elastic_physics> = TACTUS_ELASTIC_PHYSICS;
template <>
inline constexpr std::int32_t kKind<tactus_sender_options> = TACTUS_SENDER_OPTIONS;
template <>
inline constexpr std::int32_t kKind<tactus_truth> = TACTUS_TRUTH;
template <>
inline constexpr std::int32_t kKind<tactus_server_options> = TACTUS_SERVER_OPTIONS;
template <>
inline constexpr std::int32_t kKind<tactus_client_options> = TACTUS_CLIENT_OPTIONS;

/// Fills in defaults, as tactus_init() does.
template <class T>
inline constexpr auto init = [](T* options, std::size_t size) { return tactus_init(kKind<T>, options, size); };

template <class T>
T sized() {
  T out{};
  out.size = sizeof(T);
  return out;
}

}  // namespace tactus::c_test
