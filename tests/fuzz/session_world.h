// SPDX-License-Identifier: Apache-2.0
/// A server, a client and a stranger, who all keep to the rules of a session unless a test asks otherwise.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/session/datagram.h>
#include <tactus/session/session_client.h>
#include <tactus/session/session_server.h>
#include "tests/fuzz/require.h"

namespace tactus::testing {

using Bytes = std::vector<std::uint8_t>;
using Input = std::span<const std::uint8_t>;

inline const std::array<SharedScene, 3> kScenes = [] {
  const TriMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 3, 2}}};
  SceneBuilder plain(1000), layered(60), driven(1000);
  plain.rigid("a").rigid("b").baselines(64);
  layered.rigid("a").deformable("m", mesh, {.layered = true}).deformable("n", mesh).baselines(4);
  driven.rigid("a", {}, {.driven = DrivenPhysics{0.1, {1e-5, 1e-5, 1e-5}, 500, 50, 0.5, 1}}).baselines(64);
  return std::array{plain.build().value(), layered.build().value(), driven.build().value()};
}();

/// A numbered datagram after the newest of its direction.
inline Bytes numbered(const Bytes& newest, unsigned ahead, unsigned form, Input body) {
  const unsigned number = newest.size() > 2 && newest[0] % 4 != 0 ? (newest[0] + 256u * newest[1]) / 4 : 0,
                 head = 4 * (number + ahead) + form;
  Bytes out{static_cast<std::uint8_t>(head), static_cast<std::uint8_t>(head >> 8)};
  out.insert(out.end(), body.begin(), body.end());
  return out;
}

inline Bytes without_check(const Bytes& datagram) {
  return Bytes(datagram.begin(), datagram.end() - std::min<std::ptrdiff_t>(4, std::ssize(datagram)));
}

/// A true datagram under a next number, changed from the byte that the first of `bytes` names.
inline Bytes changed(const Bytes& newest, unsigned ahead, Input bytes) {
  Bytes out = without_check(newest);
  if (out.size() > 2) out = numbered(newest, ahead, out[0] % 4, std::span(out).subspan(2));
  for (std::size_t i = 1; i < bytes.size() && 1u + bytes[0] + i < out.size(); ++i) out[1u + bytes[0] + i] ^= bytes[i];
  return out;
}

struct World {
  SessionServer server = SessionServer::create(kScenes[0], {.clients = 2, .rate = 1'000'000}, 5, 1000).value();
  SessionClient client = SessionClient::create({.role = Role::participant, .limits = {.header_bytes = 1 << 20}}).value();
  SharedScene scene = kScenes[0];
  std::uint64_t now = 1000;
  std::int64_t tick = 0;
  struct Peer {  // 1: the client's address, 2: the stranger's
    std::uint64_t epoch = 0, heard = 0, sent = 0;
    bool validated = false;
  };
  std::array<Peer, 3> peers{};
  Bytes up, down;  // the newest of each way
  Bytes join = [] {
    DatagramWriter writer(Direction::up);
    const auto message = writer.write(Join{Role::participant, 9, 1 << 30, 1 << 30});
    return Bytes(message.begin(), message.end());
  }();

  void to_server(std::uint64_t peer, Input bytes) {
    Peer& from = peers[peer];
    from.heard += bytes.size();
    from.validated = from.validated || (from.epoch != 0 && is_of_epoch(bytes, from.epoch, Direction::up));
    static_cast<void>(server.handle_datagram(now, peer, bytes));
  }
  void drain(bool delivers) {
    while (const auto datagram = server.poll_datagram(now)) {
      Peer& to = peers.at(datagram->peer);
      const auto message = read_datagram(datagram->bytes, Direction::down);
      require(message && datagram->bytes.size() <= kLargestDatagram);
      to.sent += datagram->bytes.size();
      require(to.validated || to.sent <= to.heard);
      if (const auto* welcome = std::get_if<Welcome>(&*message)) to.epoch = welcome->epoch;
      if (datagram->peer != 1) continue;
      down.assign(datagram->bytes.begin(), datagram->bytes.end());
      if (delivers) static_cast<void>(client.handle_datagram(now, down));
    }
    while (const auto datagram = client.poll_datagram(now)) {
      require(read_datagram(*datagram, Direction::up) && datagram->size() <= kLargestDatagram);
      up.assign(datagram->begin(), datagram->end());
      if (delivers) to_server(1, up);
    }
    while (server.poll_event() || client.poll_event()) continue;
  }
  void replace(const SharedScene& other) {
    if (!server.replace_scene(other, now)) return;
    scene = other;
    tick = 0;
  }
  /// With the check of the peer's epoch, or of none.
  void hostile(Bytes body, bool handshake, Direction direction, std::uint64_t peer) {
    body.resize(std::min(body.size(), kLargestDatagram - 4));
    std::array<std::uint8_t, 9> front{};
    for (std::size_t i = 0; i < 8 && !handshake; ++i) front[i] = static_cast<std::uint8_t>(peers[peer].epoch >> (8 * i));
    front[8] = static_cast<std::uint8_t>(direction);
    const std::uint32_t check = crc32(body, crc32(front));
    for (int i = 0; i < 4; ++i) body.push_back(static_cast<std::uint8_t>(check >> (8 * i)));
    if (direction == Direction::up) to_server(peer, body);
    else static_cast<void>(client.handle_datagram(now, body));
  }
};

}  // namespace tactus::testing
