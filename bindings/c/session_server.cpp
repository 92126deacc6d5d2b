// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/session_server.h>

#include <memory>

#include "session.h"
#include "truth.h"

struct tactus_server {
  tactus::SessionServer server;
  tactus::c::TruthBuffer truth;
  tactus::c::Answer answer;
  tactus::SharedScene scene;
  tactus::c::Clock clock{};
};

namespace tactus::c {
namespace {

tactus_server_options server_options() noexcept {
  const SessionServerOptions defaults;
  return {.size = sizeof(tactus_server_options),
          .clients = defaults.clients,
          .headers = defaults.headers,
          .reserved = 0,
          .rate = defaults.rate,
          .silence = defaults.silence,
          .max_bound_scale = defaults.max_bound_scale,
          .sender = nullptr,
          .world = 0};
}

Result<SessionServerOptions> session_options(const tactus_server_options* options) noexcept {
  TACTUS_TRY(const tactus_server_options o, given_or(options, server_options()));
  if (o.clients > 0xffff || o.headers > 0xffff || o.silence > kLastTime) return fail(Errc::invalid_argument, "R-API-4");
  SessionServerOptions out{.sender = {},
                           .clients = static_cast<std::uint16_t>(o.clients),
                           .rate = o.rate,
                           .headers = o.headers,
                           .max_bound_scale = o.max_bound_scale,
                           .silence = o.silence,
                           .world = o.world};
  TACTUS_TRY(out.sender, options_of(o.sender));
  return out;
}

std::uint32_t kind_of(ServerEvent::Kind kind) noexcept {
  switch (kind) {
    case ServerEvent::Kind::joined:
      return TACTUS_EVENT_JOINED;
    case ServerEvent::Kind::live:
      return TACTUS_EVENT_LIVE;
    case ServerEvent::Kind::left:
      return TACTUS_EVENT_CLOSED;
    case ServerEvent::Kind::moved:
      return TACTUS_EVENT_MOVED;
    case ServerEvent::Kind::refused:
      return TACTUS_EVENT_REFUSED;
    case ServerEvent::Kind::bounds_scaled:
      break;
  }
  return TACTUS_EVENT_BOUNDS_SCALED;
}

/// A session of this server at a time.
Result<SessionServer*> at(tactus_server* server, std::uint64_t now) noexcept {
  if (server == nullptr) return refuse();
  TACTUS_CHECK(server->clock.advance(now));
  return &server->server;
}

Result<std::uint16_t> client_of(const tactus_server* server, std::uint32_t client) noexcept {
  if (server == nullptr || client >= server->server.clients()) return refuse();
  return static_cast<std::uint16_t>(client);
}

tactus_session_status status_of(const ClientStatus& status) noexcept {
  tactus_session_status out{};
  out.state = static_cast<std::uint32_t>(status.state);
  out.client = status.client;
  out.role = static_cast<std::uint32_t>(status.role);
  out.seat = status.seat;
  out.wanted_seat = status.wanted_seat;
  out.peer = status.peer;
  out.loss = status.loss;
  out.bound_scale = status.bound_scale;
  out.largest_bound_scale = status.bound_scaling.largest;
  out.bounds_scaled_time = status.bound_scaling.time;
  add(status.round_trip, out);
  add(status.traffic, out);
  return out;
}

tactus_device_sample sample_of(const DeviceSample& sample) noexcept {
  const auto& [p, q, v, buttons, time] = sample;
  return {.position = {p.x, p.y, p.z},
          .orientation = {q.w, q.x, q.y, q.z},
          .velocity = {v.x, v.y, v.z},
          .buttons = buttons,
          .reserved = 0,
          .time = time};
}

}  // namespace

template <>
tactus_server_options defaults<tactus_server_options>() noexcept {
  return server_options();
}

}  // namespace tactus::c

using namespace tactus;
using namespace tactus::c;

tactus_status tactus_server_create(const tactus_scene* scene, const tactus_server_options* options, uint64_t entropy,
                                   uint64_t now, tactus_server** server, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (scene == nullptr || !scene->shared || server == nullptr || now > kLastTime) return refuse();
    TACTUS_TRY(const SessionServerOptions chosen, session_options(options));
    TACTUS_TRY(SessionServer made, SessionServer::create(scene->shared, chosen, entropy, now));
    auto out = std::make_unique<tactus_server>(
        tactus_server{std::move(made), TruthBuffer(*scene->shared), Answer(*scene->shared), scene->shared});
    TACTUS_CHECK(out->clock.advance(now));
    *server = out.release();
    return TACTUS_OK;
  });
}

void tactus_server_destroy(tactus_server* server) { delete server; }

tactus_status tactus_server_handle_datagram(tactus_server* server, uint64_t now, uint64_t peer, const uint8_t* datagram,
                                            size_t size, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (peer == 0) return refuse();
    TACTUS_TRY(const auto bytes, span_of(datagram, size));
    TACTUS_TRY(SessionServer * to, at(server, now));
    TACTUS_CHECK(to->handle_datagram(now, peer, bytes));
    return TACTUS_OK;
  });
}

tactus_status tactus_server_handle_timeout(tactus_server* server, uint64_t now, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(SessionServer * to, at(server, now));
    to->handle_timeout(now);
    return TACTUS_OK;
  });
}

tactus_status tactus_server_submit(tactus_server* server, uint64_t now, int64_t tick, const tactus_truth* truth,
                                   tactus_encoded* encoded, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (server == nullptr) return refuse();
    if (encoded != nullptr) TACTUS_CHECK(check_answer(encoded));
    TACTUS_TRY(const Truth taken, server->truth.of(truth));
    if (server->truth.number()) return refuse();
    TACTUS_TRY(SessionServer * to, at(server, now));
    TACTUS_CHECK(to->submit(now, tick, taken));
    if (encoded == nullptr) return TACTUS_OK;
    server->answer.take(*server->scene, tick, {}, to->held());
    answer(encoded, server->answer.given());
    return TACTUS_OK;
  });
}

tactus_status tactus_server_replace_scene(tactus_server* server, const tactus_scene* scene, uint64_t now, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (scene == nullptr || !scene->shared) return refuse();
    TACTUS_TRY(SessionServer * to, at(server, now));
    TruthBuffer truth(*scene->shared);
    Answer answer(*scene->shared);
    TACTUS_CHECK(to->replace_scene(scene->shared, now));
    server->truth = std::move(truth);
    server->answer = std::move(answer);
    server->scene = scene->shared;
    return TACTUS_OK;
  });
}

tactus_status tactus_server_seat(tactus_server* server, uint32_t client, uint32_t seat, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const std::uint16_t number, client_of(server, client));
    if (seat > TACTUS_ONLY_LOOKS_ON) return refuse();
    server->server.seat(number, static_cast<std::uint8_t>(seat));
    return TACTUS_OK;
  });
}

tactus_status tactus_server_close(tactus_server* server, uint32_t client, uint32_t reason, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (server == nullptr || !is_reason(reason)) return refuse();
    if (client == TACTUS_EVERY_CLIENT) {
      server->server.close();
      return TACTUS_OK;
    }
    TACTUS_TRY(const std::uint16_t which, client_of(server, client));
    server->server.close(which, static_cast<LeaveReason>(reason));
    return TACTUS_OK;
  });
}

tactus_status tactus_server_poll_datagram(tactus_server* server, uint64_t now, uint64_t* peer, uint8_t* bytes, size_t capacity,
                                          size_t* size, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_CHECK(check_room(bytes, capacity, size));
    if (peer == nullptr) return refuse();
    TACTUS_TRY(SessionServer * of, at(server, now));
    const auto datagram = of->poll_datagram(now);
    if (!datagram) return TACTUS_NOTHING;
    *peer = datagram->peer;
    return copy_out(datagram->bytes, bytes, capacity, size);
  });
}

tactus_status tactus_server_poll_event(tactus_server* server, tactus_event* event, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (server == nullptr) return refuse();
    TACTUS_CHECK(check_answer(event));
    const auto happened = server->server.poll_event();
    if (!happened) return TACTUS_NOTHING;
    answer(event, {.size = 0,
                   .kind = kind_of(happened->kind),
                   .client = happened->client,
                   .reason = static_cast<std::uint32_t>(happened->reason),
                   .bound_scale = happened->bound_scale});
    return TACTUS_OK;
  });
}

tactus_status tactus_server_next_timeout(const tactus_server* server, uint64_t* time, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (server == nullptr || time == nullptr) return refuse();
    const auto next = server->server.next_timeout();
    if (!next) return TACTUS_NOTHING;
    *time = *next;
    return TACTUS_OK;
  });
}

tactus_status tactus_server_status(tactus_server* server, uint32_t client, uint64_t now, tactus_session_status* status,
                                   tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const std::uint16_t which, client_of(server, client));
    TACTUS_CHECK(check_answer(status));
    TACTUS_TRY(SessionServer * of, at(server, now));
    tactus_session_status out = status_of(of->status(which));
    if (const auto device = of->device(which, now)) {
      out.has_device = 1;
      out.device = sample_of(*device);
    }
    answer(status, out);
    return TACTUS_OK;
  });
}
