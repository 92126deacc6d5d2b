// SPDX-License-Identifier: Apache-2.0
/// Where a session is, at the client and, for each client, at the server: tables of what leads where. spec/70-session.md section 3.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace tactus {

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

}  // namespace tactus
