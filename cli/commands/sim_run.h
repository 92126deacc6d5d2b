// SPDX-License-Identifier: Apache-2.0
/// A run of `tactus sim`: its options, what it writes while it goes, and its loop over ticks.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tactus/file/stream_file.h>
#include <tactus/sim/link/session_network.h>
#include <tactus/sim/simulation.h>
#include <tactus/trace/trace_file.h>
#include "cli/commands/scene_run.h"
#include "cli/commands/sim_check.h"
#include "cli/figure/time_figure.h"
#include "cli/options/options_link.h"
#include "cli/report/held_log.h"
#include "cli/report/report.h"
#include "cli/report/sim_report.h"

namespace tactus::cli {

struct SimOptions {
  std::string scene, output, stream, replay;
  std::string pcap;           // capture to write
  std::string plot;           // figure to draw
  std::string stiffness_map;  // CSV to write
  HandArguments hands;
  std::string method, solver;  // of deformable objects, empty: the scene's
  std::uint32_t rate = 0;      // ticks between deformations, 0: the scene's
  std::uint64_t seed = 1;
  double duration = -1;   // [s], negative: the scene's
  double mesh_noise = 0;  // [m] RMS per axis
  bool codec = false, check = false;
  std::string compensation;       // empty: the scene's
  double client_model_scale = 1;  // mass and stiffness of what devices move, times the true
  TriggerArguments triggers;
  MeshArguments meshes;
  ReplicaOptions replica;
  std::optional<sim::LinkOptions> link, uplink;  // of both directions, of the one to the server
  std::string playout = "adaptive";
  CommonOptions common;

  bool has_network() const { return link || uplink; }
  bool has_channel() const {
    return codec || has_network() || !stream.empty() || triggers.any_given() || meshes.any_given() ||
           replica.interpolation != Interpolation::none;
  }
};

/// Where packets go, if anywhere.
struct StreamOutput {
  OutputFile file;
  StreamFileWriter writer;
};

tl::expected<StreamOutput, Failure> open_stream(const SimOptions& options, const Scene& scene);

struct SimRun {
  sim::Simulation simulation;
  OutputFile output;  // of the trace
  TraceWriter trace;
  std::optional<StreamOutput> stream;
  std::optional<TraceReader> recording;
  TraceFrame recorded;
  std::vector<DeviceSample> devices;  // of this tick, recorded
  std::optional<NetworkJudge> judge;  // with a network
  sim::SessionNetwork* network = nullptr;
  std::optional<MotionFigure> figure;
  std::vector<SimCheck> checks;  // finer runs beside it
  CheckedTick checked;           // for them
  HeldLog held{};
};

/// Of what was sent, or would have been.
StreamSize stream_size(const SimRun& run);

/// Until the end of the scene or the recording, or a signal; what is written is whole then.
Outcome simulate(SimRun& run, std::int64_t ticks, const SimOptions& options, Report& report);

}  // namespace tactus::cli
