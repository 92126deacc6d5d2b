// SPDX-License-Identifier: Apache-2.0
/// Work in real time: ticks, a line that shows how it goes, an end by a signal.
#pragma once

#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <string>
#include <vector>

#include "cli/progress.h"

namespace tactus::cli {

// ==== stop ====

/// While it lives, an interrupt or a request to end (SIGTERM, or SIGUSR1: another program follows) is noted instead of obeyed, so that a
/// command can close its files. The second one is obeyed.
class StopOnSignal {
 public:
  StopOnSignal();
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

  static int caught() noexcept;  ///< the signal, 0: none
};

// ==== hang-up ====

/// While it exists, SIGHUP asks to read files again. A terminal that is closed sends it, too: then it means the end, as ever.
class ReloadOnHangUp {
 public:
  ReloadOnHangUp();
  ~ReloadOnHangUp();
  ReloadOnHangUp(const ReloadOnHangUp&) = delete;
  ReloadOnHangUp& operator=(const ReloadOnHangUp&) = delete;

  /// Since it was asked last. If the terminal is gone it does not return: the signal does what it did before.
  bool caught() noexcept;

 private:
  bool had_terminal_, is_ours_;
  struct sigaction before_ {};
};

// ==== meter ====

/// One line on standard error that shows how a session does; drawn only on a terminal, five times per second, gone afterwards.
class Meter {
 public:
  explicit Meter(Visibility visibility);
  ~Meter();
  Meter(const Meter&) = delete;
  Meter& operator=(const Meter&) = delete;

  bool is_due(std::uint64_t now) const noexcept { return visible_ && now >= next_; }  ///< [us]
  void draw(std::uint64_t now, const std::string& text);

 private:
  bool visible_, drawn_ = false;
  std::uint64_t next_ = 0;
};

// ==== ticker ====
// Ticks in real time.

/// The time of this machine since some origin; it never steps back.
std::uint64_t microseconds_now() noexcept;

/// Waits for ticks at absolute times, or for datagrams before them. A tick that comes more than its period late is missed: it is counted,
/// and the ticks after it keep their times.
class Ticker {
 public:
  /// in   origin  [us] time of tick 0
  explicit Ticker(std::uint64_t period, std::uint64_t origin = microseconds_now()) noexcept
      : period_(period), due_(origin - period) {}

  enum class Woken { by_tick, by_socket };
  /// Until the next tick, a datagram at the socket, or at the latest until `timeout` [us].
  Woken wait(int socket, std::uint64_t timeout);
  /// The time that the tick just begun was due [us]: even, unlike the time at which it began.
  std::uint64_t due() const noexcept { return due_; }

  /// The tick just begun, by its time.   pre  there was one
  std::int64_t tick() const noexcept { return static_cast<std::int64_t>(ticks_ + missed_) - 1; }
  std::uint64_t ticks() const noexcept { return ticks_; }  ///< that began
  std::uint64_t missed() const noexcept { return missed_; }
  /// [us] Lateness below which this fraction of the ticks began; of those that were late by more than 10 ms it is 10 ms.
  double lateness(double fraction) const noexcept;

 private:
  bool begin(std::uint64_t now) noexcept;

  static constexpr std::size_t kBins = 1000;  // of 10 us
  std::uint64_t period_, due_;
  std::uint64_t ticks_ = 0, missed_ = 0;
  std::vector<std::uint64_t> bins_ = std::vector<std::uint64_t>(kBins);
};

}  // namespace tactus::cli
