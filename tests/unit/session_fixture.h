// SPDX-License-Identifier: Apache-2.0
/// A server and its clients over links that delay and lose, in virtual time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/session/session_client.h>
#include <tactus/session/session_server.h>
#include <tactus/sim/link/link.h>

namespace tactus::testing {

/// Everything that was sent is kept, so that tests can look at it.
class SessionWorld {
 public:
  struct End {
    std::unique_ptr<SessionClient> client;
    std::unique_ptr<sim::Link> up, down;
    std::vector<ClientEvent> events;
    bool silent = false;      // the program has died: it neither hears nor sends anything
    std::uint64_t clock = 0;  // [us] that of the client is ahead of the server's
    std::uint64_t peer = 0;   // its address
  };

  SessionWorld(const SharedScene& scene, const SessionServerOptions& options, std::uint64_t entropy = 77)
      : server(std::make_unique<SessionServer>(SessionServer::create(scene, options, entropy, now).value())),
        rate(scene->tick_rate) {}

  /// in   clock  [us] that of the client is ahead of the server's
  End& add(const SessionClientOptions& options, const sim::LinkOptions& up, const sim::LinkOptions& down, std::uint64_t clock = 0,
           std::uint64_t token = 0) {
    End& end = ends.emplace_back();
    end.client = std::make_unique<SessionClient>(SessionClient::create(options).value());
    end.up = std::make_unique<sim::Link>(sim::Link::create(up).value());
    end.down = std::make_unique<sim::Link>(sim::Link::create(down).value());
    end.clock = clock;
    end.peer = ends.size();
    end.client->open(now + clock, 1000 + ends.size(), token);
    return end;
  }

  /// One tick: `truth` of the server if there is one; then everything that happens until the next tick, each 0.1 ms.
  void step(const std::function<Truth(std::int64_t)>& truth = {}) {
    deliver();
    if (truth) {
      const auto done = server->submit(now, tick, truth(tick));
      if (!done) throw std::runtime_error(done.error().rule);
    }
    drain();
    const std::uint64_t next = now + 1'000'000 / rate;
    for (; now + 100 < next; now += 100) {
      deliver();
      drain();
    }
    now = next;
    ++tick;
  }

  void drain() {
    while (const auto datagram = server->poll_datagram(now)) {
      ++datagrams_down;
      const auto to = std::ranges::find(ends, datagram->peer, &End::peer);
      if (to != ends.end()) to->down->send(static_cast<sim::Microseconds>(now), datagram->bytes);
    }
    while (const auto event = server->poll_event()) events.push_back(*event);
    for (End& end : ends) {
      if (end.silent) continue;
      while (const auto datagram = end.client->poll_datagram(now + end.clock)) {
        ++datagrams_up;
        end.up->send(static_cast<sim::Microseconds>(now), *datagram);
      }
      while (const auto event = end.client->poll_event()) end.events.push_back(*event);
    }
  }

  void deliver() {
    for (std::size_t i = 0; i < ends.size(); ++i) {
      while (const auto datagram = ends[i].up->poll(static_cast<sim::Microseconds>(now)))
        if (!server->handle_datagram(now, ends[i].peer, datagram->bytes)) ++refused;
      while (const auto datagram = ends[i].down->poll(static_cast<sim::Microseconds>(now)))
        if (!ends[i].silent && !ends[i].client->handle_datagram(now + ends[i].clock, datagram->bytes)) ++refused;
      if (!ends[i].silent) ends[i].client->handle_timeout(now + ends[i].clock);
    }
    server->handle_timeout(now);
  }

  std::uint64_t now = 5'000'000;
  std::int64_t tick = 0;
  std::unique_ptr<SessionServer> server;
  std::uint32_t rate;
  std::vector<End> ends;
  std::vector<ServerEvent> events;
  std::uint64_t refused = 0, datagrams_up = 0, datagrams_down = 0;
};

}  // namespace tactus::testing
