// SPDX-License-Identifier: Apache-2.0
#include "session.h"

#include <tactus/session/datagram.h>

namespace tactus::c {

static_assert(TACTUS_DATAGRAM_BYTES == kLargestDatagram);
static_assert(TACTUS_ROLE_OBSERVER == static_cast<int>(Role::observer) &&
              TACTUS_ROLE_PARTICIPANT == static_cast<int>(Role::participant));
static_assert(TACTUS_SESSION_CLOSED == static_cast<int>(SessionState::closed) &&
              TACTUS_SESSION_JOINING == static_cast<int>(SessionState::joining) &&
              TACTUS_SESSION_RECEIVING == static_cast<int>(SessionState::receiving) &&
              TACTUS_SESSION_LIVE == static_cast<int>(SessionState::live));
static_assert(TACTUS_LEAVE_BYE == static_cast<int>(LeaveReason::bye) &&
              TACTUS_LEAVE_VERSION == static_cast<int>(LeaveReason::version) &&
              TACTUS_LEAVE_FULL == static_cast<int>(LeaveReason::full) &&
              TACTUS_LEAVE_LIMITS == static_cast<int>(LeaveReason::limits) &&
              TACTUS_LEAVE_SILENCE == static_cast<int>(LeaveReason::silence) &&
              TACTUS_LEAVE_SCENE == static_cast<int>(LeaveReason::scene) &&
              TACTUS_LEAVE_PROTOCOL == static_cast<int>(LeaveReason::protocol));

void add(const Traffic& traffic, tactus_session_status& out) noexcept {
  out.datagrams_sent = traffic.datagrams_sent;
  out.bytes_sent = traffic.bytes_sent;
  out.packets_sent = traffic.packets_sent;
  out.payload_sent = traffic.payload_sent;
  out.datagrams_heard = traffic.datagrams_heard;
  out.bytes_heard = traffic.bytes_heard;
  out.packets_heard = traffic.packets_heard;
  out.payload_heard = traffic.payload_heard;
  out.packets_refused = traffic.packets_refused;
  out.packets_held = traffic.packets_held;
  out.lost = traffic.lost;
  out.ticks_held = traffic.ticks_held;
  out.wrong_states = traffic.wrong_states;
}

void add(const std::optional<RoundTrip>& trip, tactus_session_status& out) noexcept {
  if (!trip) return;
  out.has_round_trip = 1;
  out.round_trip = trip->smoothed;
  out.round_trip_variation = trip->variation;
  out.round_trip_least = trip->least;
}

Result<void> check_room(const std::uint8_t* bytes, std::size_t capacity, const std::size_t* size) noexcept {
  if (bytes == nullptr || size == nullptr || capacity < kLargestDatagram) return refuse();
  return {};
}

}  // namespace tactus::c
