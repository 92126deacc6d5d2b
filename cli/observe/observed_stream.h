// SPDX-License-Identifier: Apache-2.0
/// What observers of a session are sent: packets of a stream of their own under the session's bounds, made once for all of them, and the
/// truth beside them. Text of JSON with the members that a page of `tactus view` has, in pieces.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include <tactus/sender.h>
#include <tactus/trace/trace_scene.h>
#include "cli/observe/tick_queue.h"
#include "cli/viewer/packet_log.h"
#include "cli/viewer/truth_data.h"

namespace tactus::cli {

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
  /// The ticks since the last call; once a second it is a place to begin at, which tells the hashes of the states behind it.
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
