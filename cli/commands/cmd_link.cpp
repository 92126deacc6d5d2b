// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <deque>

#include <tactus/net/udp.h>
#include "cli/live/live_report.h"
#include "cli/live/ticker.h"
#include "cli/options/options_codec.h"
#include "cli/options/options_link.h"
#include "cli/options/units.h"
#include "cli/report/json.h"
namespace tactus::cli {
namespace {

using sim::Microseconds;

constexpr std::size_t kMostClients = 64;
constexpr std::size_t kLargestDatagram = 65536;

struct ForwardOptions {
  std::string listen, to;
  sim::LinkOptions link;  // of both directions
  std::optional<sim::LinkOptions> uplink{};
  double duration = 0;  // [s], 0: until interrupted
  CommonOptions common;
};

/// A client, its socket towards the server and both directions of its network.
struct Path {
  net::Address client;
  net::UdpSocket server;
  sim::Link up, down;
  std::uint64_t refused = 0;  // by the system
};

/// Hands datagrams on, in real time. Time counts from its making.
class Forwarder {
 public:
  Forwarder(const ForwardOptions& options, net::UdpSocket own, net::Address server)
      : options_(options), own_(std::move(own)), server_(server), buffer_(kLargestDatagram) {}

  /// Wait until something comes or is due, but not past `end`, and hand on what is.
  void step(Microseconds end);
  Microseconds now() const {
    return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start_).count();
  }
  const std::deque<Path>& paths() const { return paths_; }
  const std::vector<Microseconds>& lateness() const { return lateness_; }
  std::uint64_t strangers() const { return strangers_; }

 private:
  void wait(Microseconds end);
  Path* path_of(const net::Address& client);
  void take();
  void hand_on();
  void note_late(Microseconds due);

  const ForwardOptions& options_;
  net::UdpSocket own_;
  net::Address server_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::deque<Path> paths_;
  std::vector<std::uint8_t> buffer_;
  std::vector<pollfd> handles_;
  std::vector<Microseconds> lateness_;  // of what was handed on, the last kRemembered
  std::size_t late_next_ = 0;
  std::uint64_t strangers_ = 0;  // datagrams of clients beyond the most
};

void Forwarder::step(Microseconds end) {
  wait(end);
  take();
  hand_on();
}

void Forwarder::wait(Microseconds end) {
  handles_.assign(1, {own_.handle(), POLLIN, 0});
  for (const Path& path : paths_) {
    handles_.push_back({path.server.handle(), POLLIN, 0});
    for (const sim::Link* link : {&path.up, &path.down}) end = std::min(end, link->next().value_or(end));
  }
  const Microseconds left = std::max<Microseconds>(0, end - now());
  const timespec timeout{left / 1'000'000, left % 1'000'000 * 1000};
  ::ppoll(handles_.data(), handles_.size(), &timeout, nullptr);
}

Path* Forwarder::path_of(const net::Address& client) {
  const auto found = std::ranges::find(paths_, client, &Path::client);
  if (found != paths_.end()) return &*found;
  if (paths_.size() == kMostClients) return nullptr;
  auto server = net::UdpSocket::connect(server_);
  if (!server) return nullptr;
  sim::LinkOptions down = options_.link, up = options_.uplink.value_or(down);  // each client meets a network of its own
  up.seed += 2 * paths_.size() + 1;
  down.seed += 2 * paths_.size();
  return &paths_.emplace_back(Path{client, std::move(*server), sim::Link::create(up).value(), sim::Link::create(down).value()});
}

void Forwarder::take() {
  while (const auto received = own_.receive(buffer_)) {
    if (Path* path = path_of(received->from)) path->up.send(now(), received->bytes);
    else ++strangers_;
  }
  for (Path& path : paths_)
    while (const auto received = path.server.receive(buffer_)) path.down.send(now(), received->bytes);
}

void Forwarder::hand_on() {
  for (Path& path : paths_) {
    while (const auto arrival = path.up.poll(now())) {
      if (!path.server.send(arrival->bytes)) ++path.refused;
      note_late(arrival->time);
    }
    while (const auto arrival = path.down.poll(now())) {
      if (!own_.send(path.client, arrival->bytes)) ++path.refused;
      note_late(arrival->time);
    }
  }
}

void Forwarder::note_late(Microseconds due) {
  constexpr std::size_t kRemembered = 1 << 16;
  if (lateness_.size() < kRemembered) lateness_.push_back(0);
  lateness_[late_next_] = now() - due;
  late_next_ = (late_next_ + 1) % kRemembered;
}

Json direction_json(const sim::LinkCounters& c) {
  return {{"sent", c.sent},          {"arrived", c.arrived},       {"lost", c.lost},
          {"in_outages", c.cut},     {"overflowed", c.overflowed}, {"duplicated", c.duplicated},
          {"reordered", c.reordered}};
}

Value link_value(const ForwardOptions& options, const Forwarder& forwarder, double seconds) {
  Json out{{"schema", "tactus.link/1"}, {"listen", options.listen}, {"to", options.to}, {"seconds", seconds}};
  out["clients"] = Json::array();
  for (const Path& path : forwarder.paths())
    out["clients"].push_back({{"address", path.client.text()},
                              {"up", direction_json(path.up.counters())},
                              {"down", direction_json(path.down.counters())},
                              {"refused_by_the_system", path.refused}});
  out["datagrams_of_further_clients"] = forwarder.strangers();
  std::vector<Microseconds> late = forwarder.lateness();
  if (late.empty()) return out;
  std::ranges::sort(late);
  const auto at = [&](double fraction) {
    return 1e-6 * static_cast<double>(late[static_cast<std::size_t>(fraction * static_cast<double>(late.size() - 1))]);
  };
  out["lateness"] = {{"p50_s", at(0.5)}, {"p99_s", at(0.99)}, {"max_s", at(1)}};
  return out;
}

Outcome run_link(const ForwardOptions& options) {
  TACTUS_TRY(const net::Address listen, loopback_address("--listen", options.listen));
  TACTUS_TRY(const net::Address to, loopback_address("--to", options.to));
  auto own = net::UdpSocket::bind(listen);
  if (!own) return refuse_port("--listen " + options.listen, listen.port(), errno, "udp");
  ForwardOptions shown = options;
  shown.listen = own->own().text();
  shown.to = to.text();
  if (!options.common.quiet) fmt::print(stderr, "listening at {}\n", shown.listen);
  const StopOnSignal stop;
  Forwarder forwarder(options, std::move(*own), to);
  constexpr Microseconds kLook = 100'000;  // for a signal that came just before waiting
  const Microseconds end = options.duration > 0 ? std::llround(1e6 * options.duration) : INT64_MAX;
  while (StopOnSignal::caught() == 0 && forwarder.now() < end) forwarder.step(std::min(end, forwarder.now() + kLook));
  print(link_value(shown, forwarder, 1e-6 * static_cast<double>(forwarder.now())), "link", options.common);
  return {};
}

}  // namespace

void setup_link(Command& app, Action& action) {
  auto options = std::make_shared<ForwardOptions>();
  Command& command = app.add_command("link", "Hand on UDP datagrams like a network that delays and loses");
  command.add_option("--listen", options->listen, "Port for clients, 0: any free one")->required()->type_name("PORT");
  command.add_option("--to", options->to, "Port of the server")->required()->type_name("PORT");
  add_link(command, "--link", options->link, "Network between server and clients, the same there and back [perfect]");
  add_link(command, "--uplink", options->uplink, "Network from the clients to the server, if it differs");
  add_quantity(command, "--duration", options->duration, Dimension::time, "End after this long [until Ctrl-C]");
  add_report_options(command, options->common);
  command.footer(std::string(link_help()) +
                 "\nEach client meets a network of its own: client i, from 0, has seed + 2 i down and seed + 2 i + 1 up.\n\n"
                 "Example:\n"
                 "  tactus link --listen 4001 --to 4000 --link delay=20ms,jitter=5ms,loss=1%,burst=5");
  on_chosen<ForwardOptions>(command, action, options, run_link);
}

}  // namespace tactus::cli
