// SPDX-License-Identifier: Apache-2.0
#include "cli/live/live_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <random>

#include "cli/report/figures.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;

double rate(std::uint64_t amount, double seconds) { return per(static_cast<double>(amount), seconds); }

}  // namespace

tl::expected<net::Address, Failure> loopback_address(const std::string& what, const std::string& typed) {
  const std::string full = typed.find(':') == std::string::npos ? "127.0.0.1:" + typed : typed;
  const auto address = net::Address::parse(full);
  if (!address) return refuse_arguments(what + " " + typed + ": not a port and not HOST:PORT", "Give a port from 0 to 65535.");
  if (!address->is_loopback())
    return refuse_arguments(what + " " + typed + ": not on the loopback",
                            "Give a port, or an address of this machine's loopback.");
  return *address;
}

std::uint64_t system_entropy() {
  std::random_device random;
  return std::uint64_t{random()} << 32 | random();
}

const char* name_of(SessionState state) {
  constexpr const char* kNames[]{"closed", "joining", "receiving", "live"};
  return kNames[static_cast<std::size_t>(state)];
}

const char* name_of(LeaveReason reason) {
  constexpr const char* kNames[]{"the other end has ended it",       "the server speaks another version",
                                 "the server has no room",           "the scene is too large",
                                 "nothing was heard for too long",   "the scene declaration is not valid",
                                 "the other end breaks the protocol"};
  return kNames[static_cast<std::size_t>(reason)];
}

Json traffic_json(const Traffic& t, double seconds) {
  return {{"sent",
           {{"packets", t.packets_sent},
            {"datagrams", t.datagrams_sent},
            {"payload_bit_per_s", 8 * rate(t.payload_sent, seconds)},
            {"session_bit_per_s", 8 * rate(t.bytes_sent - t.payload_sent, seconds)},
            {"udp_ipv4_bit_per_s", 8 * rate(kUdpHeader * t.datagrams_sent, seconds)},
            {"lost", t.lost}}},
          {"heard",
           {{"packets", t.packets_heard},
            {"datagrams", t.datagrams_heard},
            {"packets_refused", t.packets_refused},
            {"payload_bit_per_s", 8 * rate(t.payload_heard, seconds)}}},
          {"ticks_held", t.ticks_held},
          {"wrong_states", t.wrong_states}};
}

Json round_trip_json(const RoundTrip& trip) {
  return {{"smoothed_us", trip.smoothed}, {"variation_us", trip.variation}, {"least_us", trip.least}};
}

Json pace_json(const Ticker& ticker) {
  return {{"ticks", ticker.ticks()},
          {"missed", ticker.missed()},
          {"lateness_p50_us", ticker.lateness(0.5)},
          {"lateness_p99_us", ticker.lateness(0.99)}};
}

void traffic_heading(Table& table) {
  table.heading({"sent", "packets/s", "datagrams/s", "payload [bit/s]", "session", "UDP/IPv4", "all [bit/s]", "lost"});
}

void traffic_row(Table& table, const std::string& name, const Traffic& t, double seconds) {
  const auto whole = [](double value) { return fmt::format("{:.0f}", value); };
  const double payload = 8 * rate(t.payload_sent, seconds), all = 8 * rate(t.bytes_sent + kUdpHeader * t.datagrams_sent, seconds);
  table.row({"  " + name, fmt::format("{:.1f}", rate(t.packets_sent, seconds)),
             fmt::format("{:.1f}", rate(t.datagrams_sent, seconds)), whole(payload),
             whole(8 * rate(t.bytes_sent - t.payload_sent, seconds)), whole(8 * rate(kUdpHeader * t.datagrams_sent, seconds)),
             whole(all), percent(per(static_cast<double>(t.lost), static_cast<double>(t.datagrams_sent)))});
}

void pace_rows(Table& table, const Ticker& ticker) {
  table.heading({"ticks", "begun", "missed", "late p50", "late p99"});
  table.row({"  1 kHz", fmt::to_string(ticker.ticks()), fmt::to_string(ticker.missed()),
             fmt::format("{:.2f} ms", 1e-3 * ticker.lateness(0.5)), fmt::format("{:.2f} ms", 1e-3 * ticker.lateness(0.99))});
}

}  // namespace tactus::cli
