// SPDX-License-Identifier: Apache-2.0
#include "cli/live/live_report.h"

#include <fmt/format.h>

#include <random>

#include "cli/live/wire.h"
#include "cli/report/json.h"
#include "cli/report/report.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

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

Value traffic_value(const Traffic& t, double seconds, const std::optional<SealUse>& seal) {
  const TrafficLayers sent = sent_layers(t, seconds, seal ? seal->overhead : 0);
  Json out{{"sent",
            {{"packets", t.packets_sent},
             {"datagrams", t.datagrams_sent},
             {"payload_bit_per_s", sent.payload},
             {"session_bit_per_s", sent.session},
             {"udp_ipv4_bit_per_s", sent.headers},
             {"all_bit_per_s", sent.all()},
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

Value seal_value(const seal::Counters& c) {
  return Json{{"handshakes", c.handshakes},   {"cookies", c.cookies},   {"sealed", c.sealed},      {"opened", c.opened},
              {"unauthentic", c.unauthentic}, {"replayed", c.replayed}, {"strangers", c.strangers}};
}

Value round_trip_value(const RoundTrip& trip) {
  return Json{{"smoothed_us", trip.smoothed}, {"variation_us", trip.variation}, {"least_us", trip.least}};
}

Pace pace_of(const Ticker& ticker) { return {ticker.ticks(), ticker.missed(), ticker.lateness(0.5), ticker.lateness(0.99)}; }

Value pace_value(const Pace& pace) {
  return Json{{"ticks", pace.ticks}, {"missed", pace.missed}, {"lateness_p50_us", pace.p50}, {"lateness_p99_us", pace.p99}};
}

}  // namespace tactus::cli
