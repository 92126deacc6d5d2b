// SPDX-License-Identifier: Apache-2.0
/// What the functions of tactus.h share: the objects behind the handles, and errors.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <new>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/deformable/displacement.h>
#include <tactus/receiver.h>

#include "sizes.h"

struct tactus_scene {
  tactus::SharedScene shared;
};

struct tactus_receiver {
  std::optional<tactus::Receiver> own;  // none: borrowed from a player or a session
  tactus::Receiver* at = nullptr;
  tactus_scene scene{};
  std::span<const tactus::RigidUpdate> updates{};  // of the packet decoded last

  void borrow(tactus::Receiver* receiver) {
    at = receiver;
    scene.shared = receiver != nullptr ? receiver->scene() : nullptr;
    updates = {};
  }
};

namespace tactus::c {

inline constexpr std::int64_t kLastTick = std::int64_t{1} << 40;    ///< ticks of packets end at 2^32
inline constexpr std::uint64_t kLastTime = std::uint64_t{1} << 60;  ///< [us]

tactus_status report(const Error& error, tactus_error* out) noexcept;
/// The same where the status is none of the library's classes.
tactus_status report(tactus_status status, const Error& error, tactus_error* out) noexcept;

/// What tactus_init() fills in.
template <class T>
T defaults() noexcept;
template <>
tactus_limits defaults<tactus_limits>() noexcept;
template <>
tactus_receiver_options defaults<tactus_receiver_options>() noexcept;
template <>
tactus_scene_options defaults<tactus_scene_options>() noexcept;
template <>
tactus_rigid_options defaults<tactus_rigid_options>() noexcept;
template <>
tactus_deformable_options defaults<tactus_deformable_options>() noexcept;
template <>
tactus_driven_physics defaults<tactus_driven_physics>() noexcept;
template <>
tactus_elastic_physics defaults<tactus_elastic_physics>() noexcept;
template <>
tactus_sender_options defaults<tactus_sender_options>() noexcept;
template <>
tactus_server_options defaults<tactus_server_options>() noexcept;
template <>
tactus_client_options defaults<tactus_client_options>() noexcept;

/// Outcome of a function that succeeded: TACTUS_OK, TACTUS_NOTHING or TACTUS_BUFFER_TOO_SMALL.
using Outcome = Result<tactus_status>;

/// Run the body of a function of the interface: its error is reported, and nothing is thrown.
template <class Body>
tactus_status call(tactus_error* error, Body&& body) noexcept try {
  const Outcome outcome = std::forward<Body>(body)();
  if (!outcome) return report(outcome.error(), error);
  if (*outcome == TACTUS_BUFFER_TOO_SMALL) return report(*outcome, {Errc::invalid_argument, RuleName("R-API-13"), 0}, error);
  return *outcome;
} catch (const std::bad_alloc&) {
  return report(out_of_memory().value(), error);
} catch (const std::length_error&) {
  return report(out_of_memory().value(), error);
}

inline Result<void> check_tick(std::int64_t tick) noexcept {
  if (tick < -kLastTick || tick > kLastTick) return refuse();
  return {};
}

/// Bytes of the caller.   err  R-API-12 they are null, but there are some
template <class T>
Result<std::span<const T>> span_of(const T* data, std::size_t count) noexcept {
  if (data == nullptr && count > 0) return refuse();
  return std::span(data, count);
}

/// Copy to the caller's buffer if it is large enough.   out  size  needed or written
template <class T>
Outcome copy_out(std::span<const T> from, T* to, std::size_t capacity, std::size_t* size) noexcept {
  if (size == nullptr || (to == nullptr && capacity > 0)) return refuse();
  *size = from.size();
  if (to == nullptr || from.size() > capacity) return from.empty() ? TACTUS_OK : TACTUS_BUFFER_TOO_SMALL;
  std::memcpy(to, from.data(), from.size_bytes());
  return TACTUS_OK;
}

inline tactus_pose pose_of(const Pose& pose) noexcept {
  const auto& [p, q] = pose;
  return {{p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}};
}

/// Vectors of the grid to metres, x y z of the first one first.   pre  `out` has room for 3 per vector
inline void metres_of(std::span<const std::array<std::int32_t, 3>> vectors, unsigned position_exp, float* out) noexcept {
  for (const auto& vector : vectors) {
    const Vec3 v = to_metres(vector, position_exp);
    for (const double component : {v.x, v.y, v.z}) *out++ = static_cast<float>(component);
  }
}

inline Vec3 vec_of(const double (&v)[3]) noexcept { return {v[0], v[1], v[2]}; }
inline Pose pose_of(const tactus_pose& pose) noexcept {
  const double* q = pose.rotation;
  return {vec_of(pose.position), {q[0], q[1], q[2], q[3]}};
}

Result<DecodeLimits> limits_of(const tactus_limits* limits) noexcept;
Result<ReceiverOptions> options_of(const tactus_receiver_options* options) noexcept;
tactus_packet_info info_of(const Scene& scene, const DecodedPacket& packet) noexcept;
std::uint32_t kind_of(const Scene& scene, std::size_t substream) noexcept;

inline std::size_t substreams_of(const Scene& scene) noexcept { return scene.deformables.size() + (scene.loads ? 2u : 1u); }

}  // namespace tactus::c
