// SPDX-License-Identifier: Apache-2.0
/// What programs that take part in a session tell at their end.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include <tactus/net/udp.h>
#include <tactus/session/session_options.h>
#include <tactus/session/session_state.h>
#include <tactus/session/traffic.h>
#include "cli/command.h"
#include "cli/live/ticker.h"
#include "cli/report/table.h"

namespace tactus::cli {

/// HOST:PORT, or a port of this machine's loopback. Other machines are refused: what a session says is not sealed.
/// in   what  the option or argument, for the message
tl::expected<net::Address, Failure> loopback_address(const std::string& what, const std::string& typed);

/// 64 bits from the system.
std::uint64_t system_entropy();

const char* name_of(SessionState state);
const char* name_of(LeaveReason reason);

nlohmann::ordered_json traffic_json(const Traffic& traffic, double seconds);
nlohmann::ordered_json round_trip_json(const RoundTrip& trip);
nlohmann::ordered_json pace_json(const Ticker& ticker);

void traffic_heading(Table& table);
void traffic_row(Table& table, const std::string& name, const Traffic& traffic, double seconds);
void pace_rows(Table& table, const Ticker& ticker);

}  // namespace tactus::cli
