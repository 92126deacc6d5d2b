// SPDX-License-Identifier: Apache-2.0
#include <istream>
#include <map>
#include <optional>
#include <ostream>
#include <set>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/base/rule.h>
#include <tactus/scene/scene_syntax.h>
#include <tactus/session/datagram.h>
#include <tactus/session/session_server.h>
#include <tactus/thesis/if_built.h>
#include "conformance/session_report.h"
#include "conformance/session_script.h"

namespace tactus::conformance {
namespace {

constexpr std::uint64_t kAckDelay = 25'000;  // [us] after which an acknowledgement is due

/// What the server sends to an address.
struct Peer {
  std::uint64_t epoch = 0;
  std::uint16_t newest = 0;                                           // number of its datagrams
  std::optional<std::pair<std::uint16_t, std::uint64_t>> reported{};  // newest, missing
};

/// What it has sent after a line, apart from when.
struct Sent {
  std::map<std::uint64_t, Acknowledgement> acknowledgements;
  std::set<std::pair<std::uint64_t, std::string>> handshakes;
};

class ServerScript {
 public:
  explicit ServerScript(std::ostream& out) : out_(out) {}

  bool line(std::string_view line) {
    const std::uint64_t now = number(line, "at"), from = number(line, "from");
    std::optional<Error> error;
    const auto note = [&error](const Result<void>& done) {
      if (!done) error = done.error();
    };
    if (member(line, "serve")) {
      SharedScene scene = scene_of(*member(line, "serve"));
      const SessionServerOptions options{.clients = static_cast<std::uint16_t>(number(line, "clients"))};
      auto server = scene ? SessionServer::create(std::move(scene), options, number(line, "entropy", 16), now)
                          : Result<SessionServer>(fail(Errc::invalid_argument, "R-API-4"));
      if (!server) return false;
      server_.emplace(std::move(*server));
    }
    if (!server_) return false;
    server_->handle_timeout(now);
    if (const auto heard = member(line, "heard")) {
      const auto bytes = bytes_of(*heard);
      if (!bytes) return false;
      note(server_->handle_datagram(now, from, *bytes));
    } else if (member(line, "acknowledges")) {
      const auto parts = bytes_of(member(line, "parts").value_or(""));
      if (!parts) return false;
      note(server_->handle_datagram(now, from, acknowledgement(line, from, *parts)));
    } else if (const auto next = member(line, "scene")) {
      SharedScene scene = scene_of(*next);
      if (!scene) return false;
      note(server_->replace_scene(std::move(scene), now));
    } else if (member(line, "closes")) {
      const auto client = static_cast<std::uint16_t>(number(line, "closes"));
      server_->close(client, static_cast<LeaveReason>(number(line, "reason")));
    }
    answer(now, error);
    return true;
  }

 private:
  static SharedScene scene_of(std::string_view text) {
    const auto bytes = bytes_of(text);
    if (!bytes) return nullptr;
    auto parsed = parse_scene(*bytes, {.thesis = thesis_if_built()});
    return parsed ? std::move(parsed->scene) : nullptr;
  }
  /// Of all that the server has sent to this address.
  Bytes acknowledgement(std::string_view line, std::uint64_t from, const Bytes& parts) {
    const std::uint16_t newest = peers_[from].newest;
    DatagramWriter writer(Direction::up);
    writer.begin(number(line, "acknowledges"));
    writer.add(Acknowledgement{newest, 65535, 0});
    const auto written = writer.finish(0);
    Bytes out(written.begin(), written.end() - 4);
    out.insert(out.end(), parts.begin(), parts.end());
    const auto put = [](Bytes& to, std::uint64_t value, int bytes) {
      for (int i = 0; i < bytes; ++i) to.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    };
    Bytes front;
    put(front, number(line, "epoch", 16), 8);
    put(front, 0, 1);  // up
    put(out, crc32(out, crc32(front)), 4);
    return out;
  }
  void hear(std::uint64_t to, std::span<const std::uint8_t> datagram, Sent& sent) {
    const Datagram read = read_datagram(datagram, Direction::down).value();
    Peer& peer = peers_[to];
    if (const auto* numbered = std::get_if<Numbered>(&read)) {
      peer.newest = numbered->number;
      PartReader parts = numbered->parts(Direction::down);
      while (const auto part = parts.next().value())
        if (const auto* ack = std::get_if<Acknowledgement>(&*part)) sent.acknowledgements[to] = *ack;
      return;
    }
    sent.handshakes.emplace(to, hex(datagram));
    const auto* welcome = std::get_if<Welcome>(&read);
    if (welcome != nullptr && welcome->epoch != peer.epoch) peer = {.epoch = welcome->epoch};
  }

  void answer(std::uint64_t now, const std::optional<Error>& error) {
    Sent sent;
    while (const auto datagram = server_->poll_datagram(now + kAckDelay)) hear(datagram->peer, datagram->bytes, sent);
    out_ << R"({"line":)" << lines_++;
    write_clients();
    write_left();
    if (error) out_ << R"(,"error":{"errc":")" << errc_name(error->code) << R"(","rule":")" << error->rule << "\"}";
    write_acknowledgements(sent);
    if (!sent.handshakes.empty()) {
      List list(out_, "says");
      for (const auto& [to, bytes] : sent.handshakes) list.item() << '[' << to << ",\"" << bytes << "\"]";
    }
    write_devices(now);
    out_ << "}\n";
  }
  /// "name":[item,item]
  class List {
   public:
    List(std::ostream& out, const char* name) : out_(out) { out_ << ",\"" << name << "\":["; }
    ~List() { out_ << ']'; }
    List(const List&) = delete;
    List& operator=(const List&) = delete;
    std::ostream& item() { return out_ << std::exchange(comma_, ","); }

   private:
    std::ostream& out_;
    const char* comma_ = "";
  };
  void write_clients() {
    constexpr const char *kStates[]{"closed", "joining", "receiving", "live"}, *kRoles[]{"observer", "participant"};
    List list(out_, "clients");
    for (std::uint16_t i = 0; i < server_->clients(); ++i) {
      const ClientStatus s = server_->status(i);
      if (s.state != SessionState::closed)
        list.item() << '[' << s.peer << ',' << i << ",\"" << kRoles[static_cast<std::size_t>(s.role)] << "\",\""
                    << kStates[static_cast<std::size_t>(s.state)] << "\"]";
    }
  }
  void write_left() {
    std::vector<ServerEvent> left;
    while (const auto event = server_->poll_event())
      if (event->kind == ServerEvent::Kind::left) left.push_back(*event);
    if (left.empty()) return;
    List list(out_, "left");
    for (const ServerEvent& event : left) list.item() << '[' << event.client << ',' << static_cast<int>(event.reason) << ']';
  }
  void write_acknowledgements(const Sent& sent) {
    std::optional<List> list;
    for (const auto& [to, ack] : sent.acknowledgements) {
      const auto before = std::exchange(peers_[to].reported, std::pair(ack.newest, ack.missing));
      if (before == peers_[to].reported) continue;
      if (!list) list.emplace(out_, "acknowledges");
      list->item() << '[' << to << ',' << ack.newest << ',' << ack.held << ",\"" << hex(ack.missing, 16) << "\"]";
    }
  }
  void write_devices(std::uint64_t now) {
    std::optional<List> list;
    for (std::uint16_t i = 0; i < server_->clients(); ++i) {
      const ClientStatus s = server_->status(i);
      if (s.state != SessionState::live || s.role != Role::participant) continue;
      if (!list) list.emplace(out_, "devices");
      list->item() << '[' << i << ",\"" << hex(server_->device_hash(i), 16) << '"';
      if (const auto device = server_->device(i, now + kAckDelay)) out_ << ',' << device->buttons;
      out_ << ']';
    }
  }

  std::ostream& out_;
  std::optional<SessionServer> server_;
  std::map<std::uint64_t, Peer> peers_;  // by address
  unsigned lines_ = 0;
};

}  // namespace

bool report_server(std::istream& script, std::ostream& out) {
  ServerScript run(out);
  for (std::string line; std::getline(script, line);)
    if (!run.line(line)) return false;
  return true;
}

}  // namespace tactus::conformance
