// SPDX-License-Identifier: Apache-2.0
/// Ticks of a session on their way to browsers.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tactus/load/load_state.h>
#include <tactus/sender.h>
#include <tactus/trace/frame.h>
#include <tactus/trace/trace_scene.h>
#include "cli/viewer/columns.h"

namespace tactus::cli {

// ==== tick queue ====
// Ticks of a running server, on their way from its loop to a thread that looks on.

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

// ==== observed stream ====
// What observers of a session are sent: packets of a stream of their own under the session's bounds, made once for all of them, and the
// truth beside them. Text of JSON with the members that a page of `tactus view` has, in pieces.

/// What is observed.
struct ObservedScene {
  TraceInfo info;
  SharedScene declared;
  SenderOptions sender;
  std::string name;               ///< of the scene
  nlohmann::ordered_json shapes;  ///< of its objects
};

class ObservedStream {
 public:
  /// in   scene  outlives this;  first  tick that it will show
  /// err  of PacketLog::create, TruthData::create, declaration_of()
  static Result<std::unique_ptr<ObservedStream>> create(const ObservedScene& scene, const ObservedTick& first);

  /// err  of PacketLog::add, TruthData::add
  Result<void> add(const ObservedTick& tick);
  /// Of what an observer gets first.
  const std::string& hello() const noexcept { return hello_; }

  struct Batch {
    std::string text;
    bool is_key = false;  ///< an observer can begin with it
  };
  /// The ticks since the last call; once a second it is a key tick, to begin at, which carries the hashes of the states behind it.
  /// in   left_out  ticks so far that did not get here
  Batch take(std::uint64_t left_out);

 private:
  ObservedStream(const ObservedScene& scene, PacketLog packets, TruthData truth);

  FrameTruth frame_truth_;
  bool has_loads_;
  std::int64_t key_spacing_;
  std::string hello_;
  PacketLog packets_;
  TruthData truth_;
  std::int64_t tick_ = -1, key_tick_ = -1;  // the last ones
  bool is_begun_ = false, is_key_ = false;  // the batch
};

}  // namespace tactus::cli
