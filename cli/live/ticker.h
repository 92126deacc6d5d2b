// SPDX-License-Identifier: Apache-2.0
/// Ticks in real time.
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

namespace tactus::cli {

/// The time of this machine since some origin; it never steps back.
std::uint64_t microseconds_now() noexcept;

/// Waits for ticks at absolute times, or for datagrams before them. A tick that comes more than its period late is missed: it is counted,
/// and the ticks after it keep their times.
class Ticker {
 public:
  explicit Ticker(std::uint64_t period) noexcept : period_(period), due_(microseconds_now()) {}

  enum class Woken { by_tick, by_socket };
  /// Until the next tick, a datagram at the socket, or at the latest until `timeout` [us].
  Woken wait(int socket, std::uint64_t timeout);
  /// The time that the tick just begun was due [us]: even, unlike the time at which it began.
  std::uint64_t due() const noexcept { return due_; }

  std::uint64_t ticks() const noexcept { return ticks_; }
  std::uint64_t missed() const noexcept { return missed_; }
  /// [us] Lateness below which this share of the ticks began; of those that were late by more than 10 ms it is 10 ms.
  double lateness(double share) const noexcept;

 private:
  bool begin(std::uint64_t now) noexcept;

  static constexpr std::size_t kBins = 1000;  // of 10 us
  std::uint64_t period_, due_;
  std::uint64_t ticks_ = 0, missed_ = 0;
  std::vector<std::uint64_t> bins_ = std::vector<std::uint64_t>(kBins);
};

}  // namespace tactus::cli
