// SPDX-License-Identifier: Apache-2.0
/// A simulated world for clients that join: who sits where, whose hand is in it, and what is reported to an operator.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tactus/session/session_server.h>
#include <tactus/sim/server.h>
#include <tactus/trace/trace_file.h>
#include "cli/live/background_work.h"
#include "cli/live/event_log.h"
#include "cli/live/monitor.h"
#include "cli/live/wire.h"
#include "cli/observe/observation.h"
#include "cli/report/held_log.h"
#include "cli/report/messages.h"

namespace tactus::cli {

/// pre  everything given outlives it
class Service {
 public:
  /// in   observation  may be null: nobody observes
  Service(sim::Server& world, SessionServer& sessions, ServerWire& wire, Observation* observation, EventLog log);

  /// Take what has come, and what time has brought.
  void hear();
  /// The world comes to this tick. Ticks that were missed are made at once, if they are few; of many the world knows nothing.
  Outcome step(std::uint64_t now, std::int64_t tick, std::optional<TraceWriter>& trace, const std::string& output);
  void send(std::uint64_t now);
  /// Look at the file of the keys with the next tick, without waiting for the next second.
  void reload() { must_look_ = true; }
  /// Take leave of all.
  void close(std::uint64_t now);
  std::size_t live() const;
  std::uint64_t refused() const { return refused_; }
  /// Whose key a client has; empty: there are no keys.
  std::string user_of(std::uint16_t client) const {
    return reported_[client].user ? reported_[client].user->name : std::string();
  }
  /// All figures that are of sessions.   time that of status() of each client; allocates nothing
  void describe(ServerFigures& out);

 private:
  /// A user of the scene.
  struct Seat {
    std::optional<std::uint16_t> client;  // that plays it
    DeviceSample device;
    bool is_lifted = false;  // the client is not heard
  };
  /// What was reported to the operator of a client.
  struct Reported {
    double bound_scale = 1;
    std::uint64_t scaled_at = 0;  // [us] since when it is another one
    bool looks_on = false;
    std::optional<WireUser> user;  // nothing: there are no keys
    bool is_removed = false;       // from the keys
    std::uint64_t dropped = 0;     // datagrams of its peer that were too much
    bool may_touch() const { return !user || user->may_touch; }
  };

  void look_after_work(std::uint64_t now);
  Outcome make_tick(std::uint64_t now, std::optional<TraceWriter>& trace, const std::string& output);
  void look_after_seats(std::uint64_t now);
  void look_after(Seat& seat, std::size_t user, std::uint64_t now);
  void leave(Seat& seat, std::size_t user, std::uint64_t now, const std::string& why);
  void give_seat(const ClientStatus& status, std::uint64_t now);
  Seat* seat_for(const ClientStatus& status, std::uint64_t now);
  std::uint8_t number_of(const Seat& seat) const { return static_cast<std::uint8_t>(&seat - seats_.data() + 1); }
  const std::string& name_of(const Seat& seat) const { return world_.scene().users[number_of(seat) - 1u].name; }
  std::uint64_t silence_of(std::uint16_t client, std::uint64_t now) const;
  void report(const ServerEvent& event, std::uint64_t now);
  void log_refusal(LeaveReason reason, std::uint64_t now);
  void log_held(std::int64_t tick, std::uint64_t now);
  void log_bound_scale(const ClientStatus& status, std::uint64_t now);
  void report(std::uint16_t client, std::uint64_t now, const char* event, const std::string& text, Json fields = Json::object());
  void look_at_keys(std::uint64_t now);
  void look_at_floods(std::uint64_t now);
  void find_user(const ClientStatus& status);
  std::string name_of(std::uint16_t client) const;
  void end(std::uint64_t peer);
  bool has_session(std::uint64_t peer) const { return sessions_.has_peer(peer); }

  sim::Server& world_;
  SessionServer& sessions_;
  ServerWire& wire_;
  Observation* observation_;
  EventLog log_;
  BackgroundWork work_;                   // of the sessions
  std::vector<Seat> seats_;               // by user of the scene
  std::vector<DeviceSample> devices_;     // the same
  std::vector<Reported> reported_;        // by client
  std::int64_t next_ = 0, left_out_ = 0;  // [ticks] the one to be made, those that the world was not simulated
  std::uint64_t refused_ = 0;
  std::uint64_t looked_at_ = 0, limited_ = 0;  // [us], datagrams: when floods were reported last
  bool must_look_ = false;
  // Since the beginning, for figures.
  TrafficTotal traffic_;
  std::uint64_t joined_ = 0, left_ = 0, moved_ = 0;
  std::array<std::uint64_t, 7> refusals_{};  // by LeaveReason
  std::uint64_t refusal_logged_at_ = 0;      // [us]
  HeldLog held_;
};

}  // namespace tactus::cli
