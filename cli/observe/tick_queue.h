// SPDX-License-Identifier: Apache-2.0
/// Ticks of a running server, on their way from its loop to a thread that looks on.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/load/load_state.h>
#include <tactus/trace/frame.h>

namespace tactus::cli {

/// What is true at one tick.
struct ObservedTick {
  TraceFrame frame;
  std::vector<ObjectLoad> loads;
  std::vector<Vec3> pushes;  // of the loads
};

/// One thread offers, another one takes, and neither waits for the other: where there is no room, a tick is left out.
/// offer() takes no lock and allocates nothing.
class TickQueue {
 public:
  /// in   like   a frame of the server: all have its sizes
  ///      loads  likewise;  users  of the scene, if it has loads
  TickQueue(const TraceFrame& like, std::size_t loads, std::size_t users);

  /// Of the server's thread.   time one atomic load while nobody watches; else that of a copy of the frame and of its new shapes
  void offer(const TraceFrame& frame, std::span<const ObjectLoad> loads) noexcept;

  // The rest is of the other thread.
  void begin_watch() noexcept;  ///< The first tick then has the shapes of all meshes.   pre  nobody watches
  void end_watch() noexcept;
  const ObservedTick* front() const noexcept;  ///< null: there is none now
  void pop() noexcept;
  std::uint64_t left_out() const noexcept { return left_out_.load(std::memory_order_relaxed); }
  std::size_t room() const noexcept { return slots_.size(); }

 private:
  void copy(const TraceFrame& frame, std::span<const ObjectLoad> loads, ObservedTick& to) noexcept;

  alignas(64) std::atomic<std::size_t> offered_{0};
  std::atomic<std::uint64_t> left_out_{0};
  std::vector<ObservedTick> slots_;
  std::vector<bool> owed_;  // of the server's thread: shapes that were left out
  std::uint32_t seen_ = 0;  // likewise: the watch of the last tick
  alignas(64) std::atomic<std::size_t> taken_{0};
  std::atomic<std::uint32_t> watch_{0};  // its number; an even one: nobody watches
};

}  // namespace tactus::cli
