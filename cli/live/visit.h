// SPDX-License-Identifier: Apache-2.0
/// What `tactus join` is while it runs: the hand and device of a participant, the session, and what is printed for the person.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <tactus/device/servo.h>
#include <tactus/net/udp.h>
#include <tactus/session/session_client.h>
#include <tactus/sim/client.h>
#include <tactus/thesis/if_built.h>
#include <tactus/trace/trace_recorder.h>
#include "cli/live/device_choice.h"
#include "cli/live/device_loop.h"
#include "cli/live/live_report.h"
#include "cli/live/ticker.h"
#include "cli/live/token_file.h"
#include "cli/live/wire.h"
#include "cli/output.h"

namespace tactus::cli {

struct JoinOptions {
  std::string server, scene, user, key, output;
  DeviceArguments device;
  std::string playout = "adaptive";
  double duration = 0;         // [s], 0: until interrupted or the end of the recording
  double device_error = 1e-4;  // [m]
  double weber_fraction = 0.04;
  DecodeLimits limits{.thesis = thesis_if_built()};
  CommonOptions common;

  bool participates() const { return !scene.empty(); }
};

/// The hand, the device and what it feels: only of a participant.
struct Body {
  std::unique_ptr<sim::Server> shapes;  // of the scene; nothing moves here
  std::unique_ptr<sim::Client> client;
  std::size_t user = 0;
  ChosenDevice chosen;
  std::unique_ptr<device::Servo> servo;  // from the first live tick on
  DeviceSample sample;                   // in the world
  device::ServoTick tick;
  device::Time begin = 0;  // of the first one
};

/// Scene and device of a participant.
tl::expected<Body, Failure> make_body(const JoinOptions& options);

/// Takes part in a session in real time, and prints for the person at the terminal what becomes of it.
class Visit {
 public:
  Visit(const JoinOptions& options, SessionClient& session, net::UdpSocket& socket, const net::Address& server, ClientWire& wire);

  Outcome hear();
  void send(std::uint64_t now);
  /// Take leave, and end what is written.
  Outcome close(std::uint64_t now);
  /// A tick of the device.   pre  live
  Outcome step(std::uint64_t now);
  /// Wait for the device's next tick.   pre  there is a body
  Outcome wait();
  Outcome render(std::uint64_t now);
  Outcome record(std::uint64_t now);
  std::string meter_text(std::uint64_t now, std::uint64_t missed) const;  ///< one line

  /// None: there is no device, or it takes no force.
  std::optional<GuardReport> guard() const;
  TickTiming tick_timing(const Ticker& ticker) const;

  std::optional<Body> body;
  std::optional<TraceRecorder> trace;
  std::optional<OutputFile> output;
  std::optional<LeaveReason> closed;
  bool was_live = false, at_end = false;
  std::uint64_t refused = 0;
  std::string played;        // the user of the scene whose hand this was; empty: it only looked on
  std::string beyond;        // names of the limits that the scene is beyond
  double largest_force = 0;  // [N]
  std::uint64_t lost = 0;    // ticks that are not in the trace

 private:
  Outcome arrive();
  void note(const Error& error);
  void look_at_network(std::uint64_t now);
  void look_at_arrival(std::uint64_t now);
  void look_at_seat(std::uint64_t now);
  void look_at_key();
  void print(const std::string& text) const;

  const JoinOptions& options_;
  SessionClient& session_;
  net::UdpSocket& socket_;
  net::Address server_;
  ClientWire& wire_;
  TokenFile token_;
  bool is_traced_ = true;  // until the server begins anew: its ticks do, too
  bool has_joined_ = false, is_unanswered_ = false, is_alone_ = false, is_unheard_ = false, is_doubted_ = false;
  std::uint64_t begun_at_ = microseconds_now(), receiving_since_ = 0, progress_shown_at_ = 0;  // [us]
  std::uint64_t renewed_at_ = 0, live_at_ = 0, silent_since_ = 0;                              // [us]
  std::optional<std::uint8_t> seat_;                                                           // as the server sent it
  TraceFrame frame_;
  std::int64_t shown_ = -1, written_ = -1;
};

}  // namespace tactus::cli
