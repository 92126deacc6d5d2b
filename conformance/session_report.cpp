// SPDX-License-Identifier: Apache-2.0
#include "conformance/session_report.h"

#include <cstdint>
#include <optional>
#include <ostream>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/session/datagram.h>
#include <tactus/session/session_client.h>
#include "conformance/session_script.h"

namespace tactus::conformance {
namespace {

constexpr std::uint64_t kAckDelay = 10'000;  // [us] after which an acknowledgement is due

/// What a client has sent, apart from when: acknowledgement, hashes, whole handshakes.
struct Sent {
  std::optional<Acknowledgement> acknowledgement;
  std::vector<HashPart> hashes;
  std::set<std::string> handshakes;

  void add(std::span<const std::uint8_t> datagram) {
    const auto read = read_datagram(datagram, Direction::up);
    const auto* numbered = read ? std::get_if<Numbered>(&*read) : nullptr;
    if (numbered == nullptr) {
      handshakes.insert(hex(datagram));
      return;
    }
    PartReader parts = numbered->parts(Direction::up);
    while (const auto part = parts.next().value_or(std::nullopt)) {
      if (const auto* ack = std::get_if<Acknowledgement>(&*part)) acknowledgement = *ack;
      if (const auto* hash = std::get_if<HashPart>(&*part)) hashes.push_back(*hash);
    }
  }
  void write(std::ostream& out) const {
    if (acknowledgement)
      out << R"(,"acknowledges":[)" << acknowledgement->newest << ',' << acknowledgement->held << ",\""
          << hex(acknowledgement->missing, 16) << "\"]";
    const char* comma = "";
    if (!hashes.empty()) out << R"(,"hashes":[)";
    for (const HashPart& hash : hashes) {
      out << comma << '[' << int{hash.substream} << ',' << hash.number << ",\"" << hex(hash.hash, 8) << "\"]";
      comma = ",";
    }
    if (!hashes.empty()) out << ']';
    comma = "";
    if (!handshakes.empty()) out << R"(,"says":[)";
    for (const std::string& handshake : handshakes) {
      out << comma << '"' << handshake << '"';
      comma = ",";
    }
    if (!handshakes.empty()) out << ']';
  }
};

class Script {
 public:
  explicit Script(std::ostream& out) : out_(out) {
    SessionClientOptions options;
    options.limits.state_bytes = std::size_t{1} << 28;
    options.limits.header_bytes = std::size_t{1} << 20;
    client_.emplace(SessionClient::create(options).value());
  }

  bool line(std::string_view line) {
    if (!member(line, "at")) return false;
    const std::uint64_t now = number(line, "at");
    std::optional<Error> error;
    client_->handle_timeout(now);
    if (member(line, "join")) {
      client_->open(now, number(line, "join", 16));
    } else if (const auto heard = member(line, "heard")) {
      const auto bytes = bytes_of(*heard);
      if (!bytes) return false;
      if (const auto taken = client_->handle_datagram(now, *bytes); !taken) error = taken.error();
    } else {
      client_->close();
    }
    answer(now, error);
    return true;
  }

 private:
  void answer(std::uint64_t now, const std::optional<Error>& error) {
    Sent sent;
    while (const auto datagram = client_->poll_datagram(now + kAckDelay)) sent.add(*datagram);
    if (sent.acknowledgement && !is_new(*sent.acknowledgement)) sent.acknowledgement.reset();
    while (const auto event = client_->poll_event())
      if (event->kind == ClientEvent::Kind::closed) reason_ = event->reason;
    const SessionState state = client_->status().state;
    constexpr const char* kStates[]{"closed", "joining", "receiving", "live"};
    out_ << R"({"line":)" << lines_++ << R"(,"state":")" << kStates[static_cast<std::size_t>(state)] << '"';
    if (state == SessionState::closed && reason_) out_ << R"(,"reason":)" << static_cast<int>(*reason_);
    if (error) out_ << R"(,"error":{"errc":")" << errc_name(error->code) << R"(","rule":")" << error->rule << "\"}";
    sent.write(out_);
    if (state == SessionState::live) write_states();
    out_ << "}\n";
  }
  bool is_new(const Acknowledgement& ack) {
    const auto before = std::exchange(reported_, {ack.newest, ack.missing});
    return before != reported_;
  }
  void write_states() {
    const Receiver& receiver = *client_->receiver();
    const Scene& scene = *receiver.scene();
    out_ << R"(,"states":[)";
    const char* comma = "";
    const std::size_t first = scene.moving().empty() && !scene.deformables.empty() ? 1 : 0;
    for (std::size_t i = first; i <= scene.deformables.size() + (scene.loads ? 1 : 0); ++i) {
      out_ << comma << '"' << hex(receiver.state_hash(i), 16) << '"';
      comma = ",";
    }
    out_ << ']';
  }

  std::ostream& out_;
  std::optional<SessionClient> client_;
  std::optional<LeaveReason> reason_;
  std::pair<std::uint16_t, std::uint64_t> reported_;  // newest, missing
  unsigned lines_ = 0;
};

}  // namespace

bool report_session(const std::string& script, std::ostream& out) {
  std::istringstream in(script);
  if (member(std::string_view(script).substr(0, script.find('\n')), "serve")) return report_server(in, out);
  Script run(out);
  for (std::string line; std::getline(in, line);)
    if (!run.line(line)) return false;
  return true;
}

}  // namespace tactus::conformance
