// SPDX-License-Identifier: Apache-2.0
/// The truth as the page holds it: objects and meshes as a second stream with fine bounds, users and errors as columns.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include <tactus/client/replica.h>
#include <tactus/metrics/errors.h>
#include <tactus/trace/trace_file.h>
#include <tactus/trace/trace_scene.h>
#include "cli/report/messages.h"
#include "cli/viewer/columns.h"
#include "cli/viewer/packet_log.h"

namespace tactus::cli {

/// How far the ghost may be off the truth.
struct GhostBounds {
  RigidTriggers rigid;
  DeformableThresholds deformable;
};
/// A twentieth of the bounds that the stream declares, or of the defaults.
GhostBounds ghost_bounds(const Scene& scene);

/// The errors of all ticks are those of `tactus compare`: of what a client shows, against the trace.
class TruthData {
 public:
  /// in   first  frame of the trace;  scene  that the client shows, outlives this
  /// err  those of scene_builder(), SceneBuilder::build(), PacketLog::create()
  static Result<TruthData> create(const TraceInfo& info, const TraceFrame& first, const Scene& scene);
  /// in   shown  at the frame's tick   err  those of PacketLog::add
  Result<void> add(const TraceFrame& frame, Replica& shown);
  std::size_t bytes() const;  ///< so far, of all that the page will hold
  void request_key() noexcept { ghost_.request_key(); }
  /// What the page must know before the ticks: the ghost's scene and how close it is.   err  of declaration_of()
  Result<nlohmann::ordered_json> declare() const;
  /// The ticks so far; it begins anew.
  nlohmann::ordered_json take();

 private:
  struct User {
    Column kind{1};
    VectorColumn device{1e-5}, contact{1e-5}, server{1e-3}, felt{1e-3}, shown{1e-3};
    bool differ = false;  // what is felt and the server's force
  };
  struct Mesh {
    Column ticks{1}, error{1e-8};
  };

  TruthData(const TraceInfo& info, const Scene& scene, const GhostBounds& bounds, PacketLog ghost);
  void add_users(const TraceFrame& frame, const std::vector<Pose>& shown);
  void add_errors(const TraceFrame& frame, const std::vector<Pose>& shown);
  void add_shapes(const TraceFrame& frame, Replica& replica);

  TraceInfo info_;
  const Scene* scene_;
  GhostBounds bounds_;
  std::optional<RigidTriggers> promised_;
  PacketLog ghost_;
  FrameTruth truth_;
  Column ticks_{1};
  std::vector<User> users_;
  std::vector<Mesh> meshes_;
  Column position_{1e-7}, rotation_{1e-6}, force_error_{1e-5}, force_bound_{1e-5};
};

}  // namespace tactus::cli
