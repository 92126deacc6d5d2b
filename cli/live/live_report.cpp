// SPDX-License-Identifier: Apache-2.0
#include "cli/live/live_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <random>

#include "cli/live/wire.h"
#include "cli/report/figures.h"
#include "cli/report/traffic_layers.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;

tl::expected<net::Address, Failure> any_address(const std::string& what, const std::string& typed) {
  const std::string full = typed.find(':') == std::string::npos ? "127.0.0.1:" + typed : typed;
  const auto address = net::Address::parse(full);
  if (!address) return refuse_arguments(what + " " + typed + ": not a port and not HOST:PORT", "Give a port from 0 to 65535.");
  return *address;
}

}  // namespace

tl::expected<net::Address, Failure> loopback_address(const std::string& what, const std::string& typed) {
  TACTUS_TRY(const auto address, any_address(what, typed));
  if (!address.is_loopback())
    return refuse_arguments(what + " " + typed + ": not on the loopback",
                            "Give a port, or an address of this machine's loopback.");
  return address;
}

tl::expected<net::Address, Failure> session_address(const std::string& what, const std::string& typed, const std::string& key) {
  TACTUS_TRY(const auto address, any_address(what, typed));
  if (key.empty() && !address.is_loopback())
    return refuse_arguments(what + " " + typed + ": not on the loopback, and there is no --key",
                            "Beyond this machine sessions are sealed. " + how_to_seal());
  return address;
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

Json traffic_json(const Traffic& t, double seconds, const std::optional<SealUse>& seal) {
  const TrafficLayers sent = sent_layers(t, seconds, seal ? seal->overhead : 0);
  Json out{{"sent",
            {{"packets", t.packets_sent},
             {"datagrams", t.datagrams_sent},
             {"payload_bit_per_s", sent.payload},
             {"session_bit_per_s", sent.session},
             {"udp_ipv4_bit_per_s", sent.headers},
             {"lost", t.lost}}},
           {"heard",
            {{"packets", t.packets_heard},
             {"datagrams", t.datagrams_heard},
             {"packets_refused", t.packets_refused},
             {"payload_bit_per_s", 8 * per(static_cast<double>(t.payload_heard), seconds)}}},
           {"ticks_held", t.ticks_held},
           {"wrong_states", t.wrong_states}};
  if (seal) out["sent"]["seal_bit_per_s"] = sent.seal;
  return out;
}

Json seal_json(const seal::Counters& c) {
  return {{"handshakes", c.handshakes},   {"cookies", c.cookies},   {"sealed", c.sealed},      {"opened", c.opened},
          {"unauthentic", c.unauthentic}, {"replayed", c.replayed}, {"strangers", c.strangers}};
}

std::string seal_text(const seal::Counters& c) {
  return fmt::format("{}; dropped: {} not authentic, {} replayed, {} of strangers", counted(c.handshakes, "handshake"),
                     c.unauthentic, c.replayed, c.strangers);
}

Json round_trip_json(const RoundTrip& trip) {
  return {{"smoothed_us", trip.smoothed}, {"variation_us", trip.variation}, {"least_us", trip.least}};
}

Pace pace_of(const Ticker& ticker) { return {ticker.ticks(), ticker.missed(), ticker.lateness(0.5), ticker.lateness(0.99)}; }

Json pace_json(const Pace& pace) {
  return {{"ticks", pace.ticks}, {"missed", pace.missed}, {"lateness_p50_us", pace.p50}, {"lateness_p99_us", pace.p99}};
}

void traffic_heading(Table& table, const std::optional<SealUse>& seal) {
  std::vector<std::string> cells{"sent", "packets/s", "datagrams/s", "payload [bit/s]", "session"};
  if (seal) cells.emplace_back("seal");
  for (const char* name : {"UDP/IPv4", "all [bit/s]", "lost"}) cells.emplace_back(name);
  table.heading(cells);
}

void traffic_row(Table& table, const std::string& name, const Traffic& t, double seconds, const std::optional<SealUse>& seal) {
  const TrafficLayers sent = sent_layers(t, seconds, seal ? seal->overhead : 0);
  const auto whole = [](double bits) { return fmt::format("{:.0f}", bits); };
  std::vector<std::string> cells{"  " + name, fmt::format("{:.1f}", sent.packets), fmt::format("{:.1f}", sent.datagrams),
                                 whole(sent.payload), whole(sent.session)};
  if (seal) cells.push_back(whole(sent.seal));
  cells.push_back(whole(sent.headers));
  cells.push_back(whole(sent.all()));
  cells.push_back(percent(per(static_cast<double>(t.lost), static_cast<double>(t.datagrams_sent))));
  table.row(cells);
}

void pace_rows(Table& table, const Pace& pace) {
  table.heading({"ticks", "begun", "missed", "late p50", "late p99"});
  table.row({"  1 kHz", fmt::to_string(pace.ticks), fmt::to_string(pace.missed), fmt::format("{:.2f} ms", 1e-3 * pace.p50),
             fmt::format("{:.2f} ms", 1e-3 * pace.p99)});
}

}  // namespace tactus::cli
