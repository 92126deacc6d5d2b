// SPDX-License-Identifier: Apache-2.0
/// What programs that take part in a session tell at their end.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include <tactus/net/udp.h>
#include <tactus/session/session_options.h>
#include "cli/command.h"
#include "cli/live/ticker.h"
#include "cli/live/wire.h"
#include "cli/report/table.h"

namespace tactus::cli {

/// HOST:PORT, or a port of this machine's loopback; no other address.   in  what  the option or argument, for the message
tl::expected<net::Address, Failure> loopback_address(const std::string& what, const std::string& typed);
/// The same; with a key any address.   in  key  what was typed for --key, or nothing
tl::expected<net::Address, Failure> session_address(const std::string& what, const std::string& typed, const std::string& key);

/// 64 bits from the system.
std::uint64_t system_entropy();

const char* name_of(SessionState state);
const char* name_of(LeaveReason reason);

/// in   seal  nothing: it is not sealed, and the seal is not mentioned
nlohmann::ordered_json traffic_json(const Traffic& traffic, double seconds, const std::optional<SealUse>& seal);
nlohmann::ordered_json seal_json(const seal::Counters& counters);
nlohmann::ordered_json round_trip_json(const RoundTrip& trip);
/// How even the ticks of a program came.
struct Pace {
  std::uint64_t ticks = 0, missed = 0;
  double p50 = 0, p99 = 0;  ///< [us] lateness
};
Pace pace_of(const Ticker& ticker);
nlohmann::ordered_json pace_json(const Pace& pace);

void traffic_heading(Table& table, const std::optional<SealUse>& seal);
void traffic_row(Table& table, const std::string& name, const Traffic& traffic, double seconds,
                 const std::optional<SealUse>& seal);
/// What was dropped: "1 handshake; dropped: 2 records that were not authentic, 3 replayed, 4 datagrams of strangers".
std::string seal_text(const seal::Counters& counters);
void pace_rows(Table& table, const Pace& pace);

}  // namespace tactus::cli
