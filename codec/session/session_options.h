// SPDX-License-Identifier: Apache-2.0
/// What both ends of a session and those who look at it share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <tactus/scene/scene.h>
#include <tactus/sender.h>
#include <tactus/signal/device_signal.h>

namespace tactus {

enum class Role : std::uint8_t {
  observer,     ///< only looks
  participant,  ///< touches: sends the samples of a device
};

/// Why a session ended or did not begin. Values are wire values.
enum class LeaveReason : std::uint8_t {
  bye,       ///< the user or the program ended it
  version,   ///< the server does not speak this version
  full,      ///< no room for another client
  limits,    ///< the scene is beyond the client's limits
  silence,   ///< nothing was heard for longer than the limit
  scene,     ///< the client refuses the declaration
  protocol,  ///< the other end breaks rules again and again
};

struct RoundTrip {
  std::int64_t smoothed = 0;   ///< [us]
  std::int64_t variation = 0;  ///< [us] mean deviation
  std::int64_t least = 0;      ///< [us] of the last 10 s
};

/// Bounds that the network did not permit to keep.
struct Widening {
  double widest = 1;       ///< factor of all bounds
  std::uint64_t time = 0;  ///< [us] in which they were widened at all
};

struct PlayoutOptions {
  /// [us] fixed delay behind the fastest packet; none: adaptive, so that nearly all packets are there before their tick is shown
  std::optional<std::uint32_t> fixed{};
};

struct SessionServerOptions {
  SenderOptions sender{};      ///< for every client; the baseline is always the acknowledged one
  std::uint16_t clients = 8;   ///< at a time
  std::uint64_t rate = 0;      ///< [bit/s] to each client, headers included; 0: no limit
  std::uint32_t headers = 28;  ///< [bytes] around a datagram: UDP and IPv4; with the seal 29 more
  /// Factor by which the bounds of a client widen at most while its rate or its network does not carry what they ask for, 1 to 64.
  /// 1: they never do, and the states that do not fit are left out.
  double widening = 8;
  std::uint64_t silence = 120'000'000;  ///< [us] after which a client counts as gone
};

struct SessionClientOptions {
  Role role = Role::observer;
  DecodeLimits limits{};
  PlayoutOptions playout{};
  DeviceCoding device{};                ///< of a participant
  bool senses_velocity = false;         ///< the samples of the device have one
  std::uint64_t silence = 120'000'000;  ///< [us] after which the server counts as gone
};

}  // namespace tactus
