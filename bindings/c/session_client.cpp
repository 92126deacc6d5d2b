// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/session_client.h>

#include <memory>
#include <utility>

#include "session.h"

struct tactus_client {
  tactus::SessionClient client;
  std::uint64_t token = 0;
  tactus::c::Clock clock{};
  tactus_receiver receiver{};

  /// The session may have a new receiver after each call.
  void follow() {
    tactus::Receiver* newest = client.receiver();
    if (newest != receiver.at || (newest != nullptr && newest->scene() != receiver.scene.shared)) receiver.borrow(newest);
  }
};

namespace tactus::c {
namespace {

tactus_client_options client_options() noexcept {
  const SessionClientOptions defaults;
  return {.size = sizeof(tactus_client_options),
          .role = static_cast<std::int32_t>(defaults.role),
          .senses_velocity = defaults.senses_velocity,
          .every_tick = defaults.device.every_tick,
          .device_position = defaults.device.position,
          .device_rotation = defaults.device.rotation,
          .device_weber = defaults.device.weber_fraction,
          .playout = -1,
          .silence = defaults.silence,
          .limits = nullptr,
          .token = 0,
          .seat = 0,
          .reserved = 0};
}

Result<SessionClientOptions> session_options(const tactus_client_options* options) noexcept {
  TACTUS_TRY(const tactus_client_options o, given_or(options, client_options()));
  TACTUS_TRY(const DecodeLimits limits, limits_of(o.limits));
  if (o.role < TACTUS_ROLE_OBSERVER || o.role > TACTUS_ROLE_PARTICIPANT || o.playout < -1 || o.playout > UINT32_MAX ||
      o.silence > kLastTime || o.seat > 0xff)
    return fail(Errc::invalid_argument, "R-API-4");
  SessionClientOptions out{.role = static_cast<Role>(o.role),
                           .limits = limits,
                           .playout = {},
                           .device = {.position = o.device_position,
                                      .rotation = o.device_rotation,
                                      .weber_fraction = o.device_weber,
                                      .every_tick = o.every_tick != 0},
                           .senses_velocity = o.senses_velocity != 0,
                           .silence = o.silence,
                           .seat = static_cast<std::uint8_t>(o.seat)};
  if (o.playout >= 0) out.playout.fixed = static_cast<std::uint32_t>(o.playout);
  return out;
}

/// Run `body` with the session at a time.
template <class Body>
tactus_status call_at(tactus_client* client, std::uint64_t now, tactus_error* error, Body&& body) noexcept {
  return call(error, [&]() -> Outcome {
    if (client == nullptr) return refuse();
    TACTUS_CHECK(client->clock.advance(now));
    const Outcome outcome = std::forward<Body>(body)(client->client);
    client->follow();
    return outcome;
  });
}

DeviceSample sample_of(const tactus_device_sample& s) noexcept {
  const double* q = s.orientation;
  return {.position = vec_of(s.position),
          .orientation = {q[0], q[1], q[2], q[3]},
          .velocity = vec_of(s.velocity),
          .buttons = s.buttons,
          .time = s.time};
}

tactus_session_status status_of(const SessionStatus& status) noexcept {
  tactus_session_status out{};
  out.state = static_cast<std::uint32_t>(status.state);
  out.client = status.client;
  out.declaration_bytes = status.declaration;
  out.declaration_received = status.received;
  out.has_clock_offset = status.clock_offset.has_value();
  out.clock_offset = status.clock_offset.value_or(0);
  out.server_start = status.start;
  out.playout_delay = status.playout_delay;
  out.loss = status.loss;
  out.bound_scale = out.largest_bound_scale = 1;
  out.seat = status.seat;
  out.token = status.token;
  out.world = status.world;
  add(status.round_trip, out);
  add(status.traffic, out);
  return out;
}

std::uint32_t kind_of(ClientEvent::Kind kind) noexcept {
  switch (kind) {
    case ClientEvent::Kind::welcomed:
      return TACTUS_EVENT_WELCOMED;
    case ClientEvent::Kind::live:
      return TACTUS_EVENT_LIVE;
    case ClientEvent::Kind::closed:
      break;
  }
  return TACTUS_EVENT_CLOSED;
}

}  // namespace

template <>
tactus_client_options defaults<tactus_client_options>() noexcept {
  return client_options();
}

}  // namespace tactus::c

using namespace tactus;
using namespace tactus::c;

tactus_status tactus_client_create(const tactus_client_options* options, tactus_client** client, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (client == nullptr) return refuse();
    TACTUS_TRY(const SessionClientOptions chosen, session_options(options));
    TACTUS_TRY(SessionClient made, SessionClient::create(chosen));
    TACTUS_TRY(const tactus_client_options given, given_or(options, client_options()));
    *client = new tactus_client{std::move(made), given.token};
    return TACTUS_OK;
  });
}

void tactus_client_destroy(tactus_client* client) { delete client; }

tactus_status tactus_client_open(tactus_client* client, uint64_t now, uint64_t nonce, tactus_error* error) {
  return call_at(client, now, error, [&](SessionClient& session) -> Outcome {
    session.open(now, nonce, std::exchange(client->token, 0));
    return TACTUS_OK;
  });
}

tactus_status tactus_client_close(tactus_client* client, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (client == nullptr) return refuse();
    client->client.close();
    client->follow();
    return TACTUS_OK;
  });
}

tactus_status tactus_client_handle_datagram(tactus_client* client, uint64_t now, const uint8_t* datagram, size_t size,
                                            tactus_error* error) {
  return call_at(client, now, error, [&](SessionClient& session) -> Outcome {
    TACTUS_TRY(const auto bytes, span_of(datagram, size));
    TACTUS_CHECK(session.handle_datagram(now, bytes));
    return TACTUS_OK;
  });
}

tactus_status tactus_client_handle_timeout(tactus_client* client, uint64_t now, tactus_error* error) {
  return call_at(client, now, error, [&](SessionClient& session) -> Outcome {
    session.handle_timeout(now);
    return TACTUS_OK;
  });
}

tactus_status tactus_client_submit(tactus_client* client, uint64_t now, const tactus_device_sample* sample,
                                   const tactus_device_contact* contact, tactus_error* error) {
  return call_at(client, now, error, [&](SessionClient& session) -> Outcome {
    if (sample == nullptr) return refuse();
    std::optional<DeviceContact> touched;
    if (contact != nullptr) touched = {.proxy = vec_of(contact->proxy), .stiffness = contact->stiffness};
    TACTUS_CHECK(session.submit(now, sample_of(*sample), touched));
    return TACTUS_OK;
  });
}

tactus_status tactus_client_set_viewpoint(tactus_client* client, uint64_t now, const double* viewpoint, tactus_error* error) {
  return call_at(client, now, error, [&](SessionClient& session) -> Outcome {
    if (viewpoint == nullptr) return refuse();
    session.set_viewpoint({viewpoint[0], viewpoint[1], viewpoint[2]});
    return TACTUS_OK;
  });
}

tactus_status tactus_client_poll_datagram(tactus_client* client, uint64_t now, uint8_t* bytes, size_t capacity, size_t* size,
                                          tactus_error* error) {
  return call_at(client, now, error, [&](SessionClient& session) -> Outcome {
    TACTUS_CHECK(check_room(bytes, capacity, size));
    const auto datagram = session.poll_datagram(now);
    if (!datagram) return TACTUS_NOTHING;
    return copy_out(*datagram, bytes, capacity, size);
  });
}

tactus_status tactus_client_poll_event(tactus_client* client, tactus_event* event, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (client == nullptr) return refuse();
    TACTUS_CHECK(check_answer(event));
    const auto happened = client->client.poll_event();
    if (!happened) return TACTUS_NOTHING;
    answer(event, {.size = 0,
                   .kind = kind_of(happened->kind),
                   .client = 0,
                   .reason = static_cast<std::uint32_t>(happened->reason),
                   .bound_scale = 1});
    return TACTUS_OK;
  });
}

tactus_status tactus_client_next_timeout(const tactus_client* client, uint64_t* time, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (client == nullptr || time == nullptr) return refuse();
    const auto next = client->client.next_timeout();
    if (!next) return TACTUS_NOTHING;
    *time = *next;
    return TACTUS_OK;
  });
}

tactus_receiver* tactus_client_receiver(tactus_client* client) {
  return client != nullptr && client->receiver.at != nullptr ? &client->receiver : nullptr;
}

tactus_status tactus_client_shown_tick(tactus_client* client, uint64_t now, int64_t* tick, tactus_error* error) {
  return call_at(client, now, error, [&](SessionClient& session) -> Outcome {
    if (tick == nullptr) return refuse();
    const std::int64_t shown = session.shown_tick(now);
    if (shown < 0) return TACTUS_NOTHING;
    *tick = shown;
    return TACTUS_OK;
  });
}

tactus_status tactus_client_status(tactus_client* client, uint64_t now, tactus_session_status* status, tactus_error* error) {
  return call_at(client, now, error, [&](SessionClient& session) -> Outcome {
    TACTUS_CHECK(check_answer(status));
    tactus_session_status out = status_of(session.status());
    out.force_fraction = session.force_fraction(now);
    answer(status, out);
    return TACTUS_OK;
  });
}
