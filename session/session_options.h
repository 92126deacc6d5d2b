// SPDX-License-Identifier: Apache-2.0
/// Options and states of a session, and what went over it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <tactus/scene/scene.h>
#include <tactus/sender.h>
#include <tactus/session/device_signal.h>

namespace tactus {

// ==== session state ====
// Where a session is, at the client and, for each client, at the server: tables of what leads where. spec/70-session.md section 3.

enum class SessionState : std::uint8_t {
  closed,     ///< not begun, or over
  joining,    ///< client: a join is on its way
  receiving,  ///< client: the scene declaration comes in pieces;  server: it goes
  live,       ///< packets travel
};

enum class SessionEvent : std::uint8_t {
  open,       ///< client: the program joins;  server: a join was accepted
  welcomed,   ///< client: an epoch begins
  refused,    ///< client: the server has refused the join
  completed,  ///< the declaration is complete and accepted
  replaced,   ///< server: the scene is another one, a new epoch begins
  rejected,   ///< client: the declaration breaks a rule or a limit
  left,       ///< the other end has left
  silent,     ///< nothing was heard for too long
  close,      ///< the program leaves
};

struct SessionTransition {
  SessionState from;
  SessionEvent event;
  SessionState to;
};

std::span<const SessionTransition> client_transitions() noexcept;
std::span<const SessionTransition> server_transitions() noexcept;  ///< of one client at the server

/// Nothing: the event does not occur in this state, and is ignored.
std::optional<SessionState> next_state(std::span<const SessionTransition> table, SessionState state, SessionEvent event) noexcept;

// ==== traffic ====

/// What an end of a session sent and heard. Sizes are those of datagrams with their check, without seal and headers of the network.
struct Traffic {
  std::uint64_t datagrams_sent = 0, bytes_sent = 0;
  std::uint64_t packets_sent = 0, payload_sent = 0;  ///< packets, and their bytes
  std::uint64_t datagrams_heard = 0, bytes_heard = 0;
  std::uint64_t packets_heard = 0, payload_heard = 0;
  std::uint64_t packets_refused = 0;  ///< could not be decoded
  std::uint64_t packets_held = 0;     ///< too large, or the program did not take their datagrams before the next tick
  std::uint64_t lost = 0;             ///< of the datagrams sent, as far as is known
  std::uint64_t ticks_held = 0;    ///< in which nothing was coded, as the rate or the missing acknowledgements did not permit it
  std::uint64_t wrong_states = 0;  ///< hashes that the other end reported and that are not those of the sender
};

// ==== session options ====
// What both ends of a session and those who look at it share.

enum class Role : std::uint8_t {
  observer,     ///< only looks
  participant,  ///< touches: sends the samples of a device
};

/// The seat of a participant that has none because it may only look on.
inline constexpr std::uint8_t kOnlyLooksOn = 255;

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
struct BoundScaling {
  double largest = 1;      ///< factor of all bounds
  std::uint64_t time = 0;  ///< [us] in which they were scaled at all
};

struct PlayoutOptions {
  /// [us] fixed delay behind the fastest packet; none: adaptive, so that nearly all packets are there before their tick is shown
  std::optional<std::uint32_t> fixed{};
};

/// What the packets to a client build on, and so what a loss costs. Layers and profile thesis are as with `prompt`. spec/70-session.md section 4.4
enum class LossPolicy : std::uint8_t {
  by_role,  ///< repair for observers, unless they fix a playout delay too short for it; prompt for participants: a hand feels the delay
  repair,  ///< on the packet before; what is lost goes again, and the client shows the past by a round trip more: a half to a third of the bits
  prompt,  ///< on what was acknowledged; nothing waits for what is lost, and the client interpolates over it
};

struct SessionServerOptions {
  SenderOptions sender{};  ///< for every client; the baselines are those of `loss`
  LossPolicy loss = LossPolicy::by_role;
  std::uint16_t clients = 8;   ///< at a time
  std::uint64_t rate = 0;      ///< [bit/s] to each client, headers included; 0: no limit
  std::uint32_t headers = 28;  ///< [bytes] around a datagram: UDP and IPv4; with the seal 29 more
  /// Factor by which the bounds of a client are scaled at most while its rate or its network does not carry what they ask for, 1 to 64.
  /// 1: they never do, and the states that do not fit are left out.
  double max_bound_scale = 8;
  std::uint64_t silence = 120'000'000;  ///< [us] after which the session of a client is closed
  std::uint64_t world = 0;              ///< what is simulated, as the clients' programs find it, too; 0: not declared
  /// The transport hands on datagrams only of peers that have answered from their address, as the seal does: the declaration goes with
  /// the welcome, a round trip sooner.
  bool addresses_are_validated = false;
  /// What takes longer than a tick may is left to the program: SessionServer::poll_work(). Else it is done within the call that needs it,
  /// which for 10^5 objects or vertices takes 20 to 50 ms of all clients.
  bool works_elsewhere = false;
};

struct SessionClientOptions {
  Role role = Role::observer;
  DecodeLimits limits{};
  PlayoutOptions playout{};
  DeviceCoding device{};                ///< of a participant
  bool senses_velocity = false;         ///< the samples of the device have one
  std::uint64_t silence = 120'000'000;  ///< [us] after which the session is closed
  std::uint8_t seat = 0;                ///< that a participant wants, from 1; 0: any
};

}  // namespace tactus
