// SPDX-License-Identifier: Apache-2.0
#include "cli/live/live_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <random>
#include <system_error>
#include <utility>

#include "cli/live/wire.h"
#include "cli/report/json.h"
#include "cli/report/report.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

bool is_number(const std::string& text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

tl::expected<net::Address, Failure> any_address(const std::string& what, const std::string& typed) {
  const auto refused = [&](const char* why, std::string remedy) {
    return refuse_arguments(fmt::format("{} {}: {}", what, typed, why), std::move(remedy));
  };
  const std::string full = is_number(typed) ? "127.0.0.1:" + typed : typed;
  const auto address = net::Address::parse(full);
  if (address) return *address;
  const std::size_t colon = typed.find(':');
  if (net::Address::has_form(full))
    return refused("no host of this name is known", "Check its spelling (`getent hosts NAME`), or give its address in numbers.");
  if (colon != typed.rfind(':') && typed[0] != '[')
    return refused("an IPv6 address stands in brackets", "Write it like [2001:db8::1]:7447.");
  if (colon == std::string::npos && !is_number(typed))
    return refused("there is no port", "Write it like 192.0.2.1:7447, [2001:db8::1]:7447 or server.example:7447.");
  return refused("not a port and not HOST:PORT", "Give a port from 0 to 65535.");
}

/// Why the system does not open a port, and what helps.
std::pair<std::string, std::string> port_trouble(std::uint16_t port, int cause, const char* protocol) {
  switch (cause) {
    case EADDRINUSE:
      return {
          "another program has this port",
          fmt::format("End it (`ss -{}lpn sport = :{}` names it), or give another port; 0: any free one.", protocol[0], port)};
    case EACCES:
    case EPERM:
      if (port < 1024) return {"ports below 1024 are for administrators", "Give a port from 1024 to 65535."};
      return {"the system does not permit it", "Give another port, or check what confines this program (container, SELinux)."};
    case EADDRNOTAVAIL:
      return {"this machine has no such address",
              "Give one that `ip address` names, or 0.0.0.0 (all of IPv4) or [::] (all of IPv4 and IPv6)."};
    case EAFNOSUPPORT:
      return {"this machine has no IPv6", "Give an address of IPv4, such as 0.0.0.0 for all."};
    case ENETUNREACH:
    case EHOSTUNREACH:
      return {"no route leads there", "Check the network of this machine: `ip route`."};
    default:
      return {std::generic_category().message(cause), "Check the address, and the network of this machine."};
  }
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

tl::unexpected<Failure> refuse_port(const std::string& what, std::uint16_t port, int cause, const char* protocol) {
  const auto [why, remedy] = port_trouble(port, cause, protocol);
  auto refused = refuse(fmt::format("{}: {}", what, why), remedy);
  refused.value().error_class = errc_name(Errc::io);
  return refused;
}

namespace {

std::string size_text(std::uint64_t bytes) {
  return bytes < 1'000'000 ? fmt::format("{:.1f} kB", 1e-3 * static_cast<double>(bytes))
                           : fmt::format("{:.1f} MB", 1e-6 * static_cast<double>(bytes));
}

std::string remedy_of_silence(const NoSession& join) {
  if (join.is_refused) return "Start `tactus serve` there, or give the port that it prints when it starts.";
  if (join.received > 0) return "Check the network between the two, and whether the server still runs.";
  return std::string("Is `tactus serve` running there, and does the network let UDP to this port pass?") +
         (join.has_key ? "" : " If it has a key, this end needs it too: --key.");
}

std::string remedy_of_end(const NoSession& join) {
  switch (join.ended.value_or(LeaveReason::bye)) {
    case LeaveReason::bye:
      return "";
    case LeaveReason::full:
      return "Join again when somebody has left; `tactus serve --clients N` has room for more.";
    case LeaveReason::version:
    case LeaveReason::protocol:
    case LeaveReason::scene:
      return "Use the same version at both ends: `tactus --version`.";
    case LeaveReason::limits:
      return fmt::format("Allow more with --limit ({}), or ask the operator of the server for a smaller scene.",
                         join.beyond.empty() ? "memory or declaration" : join.beyond);
    case LeaveReason::silence:
      return remedy_of_silence(join);
  }
  return "";
}

}  // namespace

Failure failure_of(const NoSession& join) {
  std::string why = join.ended ? name_of(*join.ended) : "interrupted";
  if (join.ended == LeaveReason::silence && join.is_refused) why = "nobody listens there";
  if (join.received > 0)
    why += fmt::format(", with {} of {} of the scene here", size_text(join.received), size_text(join.declaration));
  return {fmt::format("{}: no session: {}", join.server, why), remedy_of_end(join)};
}

std::string progress_text(std::uint64_t received, std::uint64_t declaration, std::uint64_t time) {
  const double all = static_cast<double>(declaration), here = static_cast<double>(received);
  std::string text = fmt::format("receiving the scene: {:.0f} % of {}", all > 0 ? 100 * here / all : 0, size_text(declaration));
  if (received > 0) text += fmt::format(", {:.0f} s left", std::ceil((all - here) / here * 1e-6 * static_cast<double>(time)));
  return text;
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

TickTiming tick_timing_of(const Ticker& ticker) {
  return {ticker.ticks(), ticker.missed(), ticker.lateness(0.5), ticker.lateness(0.99)};
}

Value tick_timing_value(const TickTiming& timing) {
  return Json{
      {"ticks", timing.ticks}, {"missed", timing.missed}, {"lateness_p50_us", timing.p50}, {"lateness_p99_us", timing.p99}};
}

}  // namespace tactus::cli
