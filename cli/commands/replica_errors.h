// SPDX-License-Identifier: Apache-2.0
/// How far a replica is from the truth: what compare does, and decode where it is given the truth.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tactus/trace/trace_scene.h>
#include "cli/options/options_codec.h"
#include "cli/output.h"
#include "cli/report/report.h"

namespace tactus::cli {

/// err  they are not of one scene, or the truth is what a client showed
Outcome check_same_scene(const std::string& truth_path, const TraceInfo& truth, const std::string& replica_path,
                         const TraceInfo& replica);

/// What the replica shows, of which every tick brings only what is new.
struct ShownByReplica {
  std::vector<Pose> poses;
  std::vector<std::vector<float>> shapes;  // displacements, V x 3

  explicit ShownByReplica(const TraceInfo& info);
  void take(const TraceFrame& frame);
};

/// One tick.   pre  judge_by
void add_errors(const TraceFrame& truth, const ShownByReplica& shown, Report& report);

/// Options of a command.
struct TypedBounds {
  const TriggerArguments& triggers;
  const MeshArguments& meshes;
};

/// Errors by bounds, which come from the options, else from the stream, else from the defaults.
/// in   typed  null: the command has no such options
///      info   of the truth
void judge_by(const TypedBounds* typed, const TraceInfo& info, const std::optional<TraceBounds>& declared, Report& report);

}  // namespace tactus::cli
