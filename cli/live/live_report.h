// SPDX-License-Identifier: Apache-2.0
/// What programs that take part in a session report at their end.
#pragma once

#include <optional>
#include <string>

#include <tactus/net/udp.h>
#include <tactus/session/session_options.h>
#include "cli/command.h"
#include "cli/live/ticker.h"
#include "cli/live/wire.h"

namespace tactus::cli {

struct Value;

/// HOST:PORT, or a port of this machine's loopback; no other address.   in  what  the option or argument, for the message
tl::expected<net::Address, Failure> loopback_address(const std::string& what, const std::string& typed);
/// The same; with a key any address.   in  key  what was typed for --key, or nothing
tl::expected<net::Address, Failure> session_address(const std::string& what, const std::string& typed, const std::string& key);

/// The system does not open a port: who has it, or who may not, and what helps.
/// in   what  "--listen 7447";  cause  errno
tl::unexpected<Failure> refuse_port(const std::string& what, std::uint16_t port, int cause, const char* protocol);

/// How a client came to no session.
struct NoSession {
  std::string server{};                ///< HOST:PORT
  std::optional<LeaveReason> ended{};  ///< nothing: the user ended it
  bool is_refused = false;             ///< the system there says that nobody listens
  bool has_key = false;
  std::string beyond{};  ///< names of the limits of this end that the scene is beyond, where they are known
  std::uint64_t declaration = 0, received = 0;  ///< [bytes] of the scene
};
/// Why there is none, and what would help.
Failure failure_of(const NoSession& join);

/// "receiving the scene: 25 % of 5.1 MB, 6 s left".   in  time  [us] since its first piece was asked for
std::string progress_text(std::uint64_t received, std::uint64_t declaration, std::uint64_t time);

/// 64 bits from the system.
std::uint64_t system_entropy();

const char* name_of(SessionState state);
const char* name_of(LeaveReason reason);

/// in   seal  nothing: it is not sealed, and the seal is not mentioned
Value traffic_value(const Traffic& traffic, double seconds, const std::optional<SealUse>& seal);
Value seal_value(const seal::Counters& counters);
Value round_trip_value(const RoundTrip& trip);
/// How even the ticks of a program came.
struct TickTiming {
  std::uint64_t ticks = 0, missed = 0;
  double p50 = 0, p99 = 0;  ///< [us] lateness
};
TickTiming tick_timing_of(const Ticker& ticker);
Value tick_timing_value(const TickTiming& timing);

}  // namespace tactus::cli
