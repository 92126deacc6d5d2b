// SPDX-License-Identifier: Apache-2.0
/// Structs that carry their size. The program may have been built with another version than this library, in which they are shorter or
/// longer: the head of tactus.h says what happens then.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include <tactus/base/result.h>
#include <tactus/base/rule.h>

#include "tactus_session.h"
#include "tactus_trace.h"

namespace tactus::c {

inline constexpr std::size_t kLargestStruct = 4096;  ///< [bytes] no version of a struct is larger

inline tl::unexpected<Error> refuse() noexcept { return fail(Errc::invalid_argument, "R-API-12"); }

/// `sizes` of a struct in all versions, rising; a struct that grows gets one more.
template <class T>
struct Versions;

/// Its size while `field` was its last.
#define TACTUS_UP_TO(type, field) \
  ((offsetof(type, field) + sizeof(type::field) + alignof(type) - 1) / alignof(type) * alignof(type))
#define TACTUS_SIZED(type, ...)                             \
  template <>                                               \
  struct Versions<type> {                                   \
    static constexpr std::array sizes{__VA_ARGS__};         \
    static_assert(sizes.back() == sizeof(type), "it grew"); \
  }

TACTUS_SIZED(tactus_rigid_bounds, TACTUS_UP_TO(tactus_rigid_bounds, force_floor));
TACTUS_SIZED(tactus_deformable_bounds, TACTUS_UP_TO(tactus_deformable_bounds, reserved));
TACTUS_SIZED(tactus_load_bounds, TACTUS_UP_TO(tactus_load_bounds, force_floor));
TACTUS_SIZED(tactus_limits, TACTUS_UP_TO(tactus_limits, basis_work));
TACTUS_SIZED(tactus_packet_info, TACTUS_UP_TO(tactus_packet_info, updates));
TACTUS_SIZED(tactus_scene_info, TACTUS_UP_TO(tactus_scene_info, load_users), TACTUS_UP_TO(tactus_scene_info, interest_reach));
TACTUS_SIZED(tactus_rigid_info, TACTUS_UP_TO(tactus_rigid_info, initial));
TACTUS_SIZED(tactus_deformable_info, TACTUS_UP_TO(tactus_deformable_info, has_stiffness));
TACTUS_SIZED(tactus_mesh_arrays, TACTUS_UP_TO(tactus_mesh_arrays, clusters));
TACTUS_SIZED(tactus_player_info, TACTUS_UP_TO(tactus_player_info, header_bytes));
TACTUS_SIZED(tactus_rigid_options, TACTUS_UP_TO(tactus_rigid_options, driven));
TACTUS_SIZED(tactus_encoded, TACTUS_UP_TO(tactus_encoded, held_count));
TACTUS_SIZED(tactus_receiver_options, TACTUS_UP_TO(tactus_receiver_options, limits));
TACTUS_SIZED(tactus_scene_options, TACTUS_UP_TO(tactus_scene_options, friction),
             TACTUS_UP_TO(tactus_scene_options, interest_reach), TACTUS_UP_TO(tactus_scene_options, limits));
TACTUS_SIZED(tactus_deformable_options, TACTUS_UP_TO(tactus_deformable_options, blend),
             TACTUS_UP_TO(tactus_deformable_options, elastic));
TACTUS_SIZED(tactus_driven_physics, TACTUS_UP_TO(tactus_driven_physics, damping));
TACTUS_SIZED(tactus_elastic_physics, TACTUS_UP_TO(tactus_elastic_physics, friction),
             TACTUS_UP_TO(tactus_elastic_physics, sub_steps));
TACTUS_SIZED(tactus_sender_options, TACTUS_UP_TO(tactus_sender_options, load));
TACTUS_SIZED(tactus_truth, TACTUS_UP_TO(tactus_truth, load_count), TACTUS_UP_TO(tactus_truth, moved_count),
             TACTUS_UP_TO(tactus_truth, number));
TACTUS_SIZED(tactus_event, TACTUS_UP_TO(tactus_event, bound_scale));
TACTUS_SIZED(tactus_session_status, TACTUS_UP_TO(tactus_session_status, wrong_states), TACTUS_UP_TO(tactus_session_status, world),
             TACTUS_UP_TO(tactus_session_status, device));
TACTUS_SIZED(tactus_server_options, TACTUS_UP_TO(tactus_server_options, sender), TACTUS_UP_TO(tactus_server_options, world));
TACTUS_SIZED(tactus_client_options, TACTUS_UP_TO(tactus_client_options, limits), TACTUS_UP_TO(tactus_client_options, reserved));
TACTUS_SIZED(tactus_trace_info, TACTUS_UP_TO(tactus_trace_info, source), TACTUS_UP_TO(tactus_trace_info, reserved));
TACTUS_SIZED(tactus_trace_object, TACTUS_UP_TO(tactus_trace_object, name));
TACTUS_SIZED(tactus_trace_user, TACTUS_UP_TO(tactus_trace_user, name), TACTUS_UP_TO(tactus_trace_user, reserved));
TACTUS_SIZED(tactus_trace_mesh, TACTUS_UP_TO(tactus_trace_mesh, name), TACTUS_UP_TO(tactus_trace_mesh, corners));
TACTUS_SIZED(tactus_trace_coding, TACTUS_UP_TO(tactus_trace_coding, deformable), TACTUS_UP_TO(tactus_trace_coding, world_size));
TACTUS_SIZED(tactus_errors_options, TACTUS_UP_TO(tactus_errors_options, deformable));
TACTUS_SIZED(tactus_error_summary, TACTUS_UP_TO(tactus_error_summary, worst_ratio),
             TACTUS_UP_TO(tactus_error_summary, violations));
#undef TACTUS_SIZED
#undef TACTUS_UP_TO

/// A size that a caller's struct may have: that of a version, or of a later one.
template <class T>
constexpr bool is_size_of(std::size_t size) noexcept {
  return std::ranges::find(Versions<T>::sizes, size) != Versions<T>::sizes.end() || (size > sizeof(T) && size <= kLargestStruct);
}

/// Write as far as the caller's struct goes, and 0 to what this version does not know.   pre  is_size_of<T>(size)
template <class T>
void write(T* out, std::size_t size, T value) noexcept {
  value.size = static_cast<std::uint32_t>(size);
  auto* bytes = reinterpret_cast<unsigned char*>(out);
  const std::size_t known = std::min(size, sizeof(T));
  std::memcpy(bytes, &value, known);
  std::memset(bytes + known, 0, size - known);
}

/// Fill the caller's struct with defaults.
template <class T>
tactus_status init(T* out, std::size_t size, const T& defaults) noexcept {
  if (out == nullptr || !is_size_of<T>(size)) return TACTUS_INVALID_ARGUMENT;
  write(out, size, defaults);
  return TACTUS_OK;
}

/// The caller's options, with the defaults where his struct does not reach; or all defaults.
/// err  R-API-12 its size is that of no version, or an option of a later version is set, or what is reserved
template <class T>
Result<T> given_or(const T* given, const T& defaults) noexcept {
  if (given == nullptr) return defaults;
  const std::size_t size = given->size;
  if (!is_size_of<T>(size)) return refuse();
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  if (size > sizeof(T) && std::any_of(bytes + sizeof(T), bytes + size, [](unsigned char byte) { return byte != 0; }))
    return refuse();
  T out = defaults;
  std::memcpy(&out, bytes, std::min(size, sizeof(T)));
  if constexpr (requires { out.reserved; })
    if (out.reserved != 0) return refuse();
  return out;
}

/// err  R-API-12 there is no struct for the answer, or its size is that of no version
template <class T>
Result<void> check_answer(const T* out) noexcept {
  if (out == nullptr || !is_size_of<T>(out->size)) return refuse();
  return {};
}

/// pre  check_answer()
template <class T>
void answer(T* out, const T& value) noexcept {
  write(out, out->size, value);
}

}  // namespace tactus::c
