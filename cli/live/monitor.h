// SPDX-License-Identifier: Apache-2.0
/// What a server reports to those who watch over it: figures that its loop makes once a second, as text for Prometheus, and whether it is
/// healthy. The loop only counts; all texts are made by the thread that asks for them.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <tactus/seal/key.h>
#include <tactus/session/session_server.h>

namespace tactus::cli {

// ==== figures ====

/// Durations in buckets.   time of add() a few comparisons
class Durations {
 public:
  static constexpr std::array<std::uint32_t, 10> kBounds{10,  25,   50,   100,  250,
                                                         500, 1000, 2500, 5000, 10'000};  ///< [us] inclusive

  void add(std::uint64_t duration) noexcept {
    std::size_t bucket = 0;
    while (bucket < kBounds.size() && duration > kBounds[bucket]) ++bucket;
    ++counts_[bucket];
    sum_ += duration;
  }
  const std::array<std::uint64_t, kBounds.size() + 1>& counts() const noexcept {
    return counts_;
  }                                                    ///< of each; the last is beyond
  std::uint64_t sum() const noexcept { return sum_; }  ///< [us]

 private:
  std::array<std::uint64_t, kBounds.size() + 1> counts_{};
  std::uint64_t sum_ = 0;
};

/// Of all sessions since the server began, with those that are over.
class TrafficTotal {
 public:
  explicit TrafficTotal(std::size_t clients) : seen_(clients) {}
  /// What its session counted so far: less than before means that it is another one.
  void add(std::uint16_t client, const Traffic& traffic) noexcept;
  const Traffic& sum() const noexcept { return sum_; }

 private:
  Traffic sum_;
  std::vector<Traffic> seen_;
};

/// At one time.
struct ServerFigures {
  std::uint64_t ticks = 0, missed = 0;                ///< that began, that did not begin in time
  std::uint64_t recent_ticks = 0, recent_missed = 0;  ///< of the last 10 s: those that were due, and did not begin in time
  Durations work{}, lateness{};                       ///< of ticks
  std::vector<ClientStatus> clients{};                ///< by number; those without a session are closed
  std::size_t seats = 0, seats_taken = 0;
  std::uint64_t joined = 0, left = 0, moved = 0;
  std::array<std::uint64_t, 7> refused{};  ///< joins, by LeaveReason
  std::uint64_t datagrams_refused = 0;
  std::uint64_t datagrams_dropped = 0;  ///< by the system, as its queue was full
  std::uint64_t datagrams_limited = 0;  ///< by this program, as their senders sent too much
  Traffic traffic{};
  std::optional<seal::Counters> seal{};
};

/// What does not change while it runs.
struct ServerFacts {
  std::string scene{};
  std::size_t objects = 0, meshes = 0;
  std::uint64_t headers = 0, seal = 0;  ///< [bytes] around each datagram: of UDP and IP; of the seal
};

/// Text format 0.0.4 of Prometheus.
std::string prometheus_text(const ServerFigures& figures, const ServerFacts& facts);

struct Health {
  bool is_well = false;
  std::string text;  ///< a sentence
};
/// in   last_tick  [us] when the last one ended, 0: there was none
Health health_of(const ServerFigures& figures, std::uint64_t last_tick, std::uint64_t now);

// ==== monitor ====

/// Between the loop and whoever asks: neither waits for the other.
class Monitor {
 public:
  explicit Monitor(std::size_t clients) : loop_{.clients = std::vector<ClientStatus>(clients)}, shown_(loop_) {}

  // Of the loop. Allocates nothing.

  struct Tick {
    std::uint64_t lateness = 0, work = 0;  ///< [us]
    std::uint64_t ticks = 0, missed = 0;   ///< so far
  };
  /// One has ended.   in  now  [us]   out  what the loop shall fill in and then show(), once a second; null: not now
  ServerFigures* tick(std::uint64_t now, const Tick& tick) noexcept;
  void show() noexcept;

  // Of any other thread.

  ServerFigures figures() const;
  Health health(std::uint64_t now) const { return health_of(figures(), last_tick_.load(std::memory_order_relaxed), now); }

 private:
  struct Second {
    std::uint64_t due = 0, missed = 0;  // so far
  };
  static constexpr std::uint64_t kEvery = 1'000'000;  // [us]

  ServerFigures loop_;
  std::uint64_t next_ = 0;
  std::array<Second, 10> seconds_{};
  std::size_t second_ = 0;
  std::atomic<std::uint64_t> last_tick_{0};
  mutable std::mutex mutex_;
  ServerFigures shown_;  // guarded by it
};

}  // namespace tactus::cli
