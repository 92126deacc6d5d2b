// SPDX-License-Identifier: Apache-2.0
/// What a server does for browsers that observe its session. It runs in a thread of its own, from which the server's loop never waits
/// for anything: it hands over copies of its ticks while somebody observes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <tactus/load/load_state.h>
#include <tactus/sender.h>
#include <tactus/trace/frame.h>
#include "cli/report/messages.h"

namespace tactus::cli {

struct ObservationReport {
  std::string address;  ///< "http://127.0.0.1:8080/"
  std::uint64_t observers = 0, most_at_a_time = 0, too_slow = 0, requests_refused = 0;
  std::uint64_t ticks_left_out = 0;
  std::string failure{};  ///< why it ended before the server; empty: it did not
};

class Observation {
 public:
  struct Setup {
    std::uint16_t port = 0;  ///< 0: any free one
    std::string scene;       ///< as it was typed
    std::string name;        ///< of it
    TraceInfo info{};
    SharedScene declared{};
    SenderOptions sender{};
    const TraceFrame* like = nullptr;  ///< a frame of the server
  };

  /// Listen, and serve in another thread.   err  the port is taken; the shapes of the scene; this program has no page
  static tl::expected<std::unique_ptr<Observation>, Failure> create(const Setup& setup);
  virtual ~Observation() = default;

  virtual const std::string& address() const noexcept = 0;
  /// A tick of the server.   time, allocations: those of TickQueue::offer
  virtual void offer(const TraceFrame& frame, std::span<const ObjectLoad> loads) noexcept = 0;
  /// Notify the observers that it is over, and end the thread.
  virtual ObservationReport finish() = 0;
};

}  // namespace tactus::cli
