// SPDX-License-Identifier: Apache-2.0
/// What programs that take part in a session tell at their end.
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

/// 64 bits from the system.
std::uint64_t system_entropy();

const char* name_of(SessionState state);
const char* name_of(LeaveReason reason);

/// in   seal  nothing: it is not sealed, and the seal is not mentioned
Value traffic_value(const Traffic& traffic, double seconds, const std::optional<SealUse>& seal);
Value seal_value(const seal::Counters& counters);
Value round_trip_value(const RoundTrip& trip);
/// How even the ticks of a program came.
struct Pace {
  std::uint64_t ticks = 0, missed = 0;
  double p50 = 0, p99 = 0;  ///< [us] lateness
};
Pace pace_of(const Ticker& ticker);
Value pace_value(const Pace& pace);

}  // namespace tactus::cli
