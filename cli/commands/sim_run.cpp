// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/sim_run.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include <tactus/scene/scene_syntax.h>
#include "cli/commands/input.h"
#include "cli/live/ticker.h"
#include "cli/report/table.h"

namespace tactus::cli {

tl::expected<StreamOutput, Failure> open_stream(const SimOptions& options, const Scene& scene) {
  TACTUS_TRY(auto file, OutputFile::create(options.stream, options.common.existing(),
                                           {options.output, options.stiffness_map, options.scene, options.replay}));
  TACTUS_TRY(const auto out, file.open());
  auto writer = StreamFileWriter::create(*out, scene);
  if (!writer) return refuse(options.stream, writer.error());
  return StreamOutput{std::move(file), std::move(*writer)};
}

StreamSize stream_size(const SimRun& run) {
  if (run.stream) return {run.stream->writer.header_bytes(), run.stream->writer.bytes()};
  const auto declaration = write_scene(*run.simulation.stream_scene());
  return {declaration ? declaration->size() : 0, std::nullopt};
}

namespace {

/// One tick, by the scene's hands or by the recording.
tl::expected<std::span<const Packet>, Failure> step(SimRun& run, const SimOptions& options, StepTimes& times) {
  if (run.recording) run.devices = recorded_devices(*run.recording, run.recorded);
  const auto stepped = times.measure([&] { return run.recording ? run.simulation.step(run.devices) : run.simulation.step(); });
  if (stepped) return *stepped;
  Diagnostic error = stepped.error();
  std::string location = location_of_tick(std::exchange(error.step, -1));
  if (const std::string within = location_of(error); !within.empty()) location += ", " + within;
  auto refused = refuse(options.scene, location, error.error);
  if (!error.remedy.empty()) refused.value().remedy = error.remedy + '.';
  return refused;
}

/// What was sent in this tick.
Outcome record_packets(SimRun& run, std::span<const Packet> packets, const SimOptions& options, Report& report) {
  for (const Packet& packet : packets) {
    if (packet.substream > report.meshes.size()) report.loads->add(packet.bytes.size(), packet.updates);
    else if (packet.substream > 0)
      report.meshes[packet.substream - 1].traffic->add(packet.bytes.size(), packet.updates, packet.key, packet.layer);
    else if (report.traffic) report.traffic->add(packet.reason, packet.updates, packet.bytes.size(), packet.key);
    if (run.figure) run.figure->add_packet(run.simulation.frame().tick, packet.bytes.size());
    if (!run.stream) continue;
    const auto added = run.stream->writer.add(run.simulation.frame().tick, packet.number, packet.bytes, packet.key);
    if (!added) return refuse(options.stream, added.error());
  }
  return {};
}

/// What the client shows of deformable objects that are new in this tick.
void judge_meshes(SimRun& run, Report& report) {
  const TraceFrame& frame = run.simulation.frame();
  for (std::size_t i = 0; i < report.meshes.size(); ++i) {
    if (!frame.meshes[i].updated) continue;
    ++report.meshes[i].traffic->frames;
    report.meshes[i].fidelity->add(frame.meshes[i].displacements, run.simulation.replica().displacements(i, frame.tick),
                                   touch_of(frame, i));
  }
}

Outcome record(SimRun& run, std::span<const Packet> packets, const SimOptions& options, Report& report) {
  const TraceFrame& frame = run.simulation.frame();
  if (const auto written = run.trace.write(frame); !written)
    return refuse(options.output, location_of_tick(frame.tick), written.error());
  TACTUS_CHECK(record_packets(run, packets, options, report));
  run.held.look(frame.tick, run.simulation.held());
  if (run.figure) run.figure->add(frame);
  if (run.judge) {
    run.judge->add(run.simulation, *run.network);
  } else if (report.fidelity) {
    judge_meshes(run, report);
    report.fidelity->add(frame, run.simulation.client_poses());
  }
  if (report.fidelity) report.fidelity->add_rendered(frame);
  report.ticks.add(frame.tick);
  return {};
}

/// How long the deformations of this tick took, one time each.
void add_deformations(const SimRun& run, StepTimes& times) {
  const auto& meshes = run.simulation.frame().meshes;
  for (std::size_t i = 0; i < meshes.size(); ++i)
    if (meshes[i].updated) {
      const sim::DeformationTime time = run.simulation.deformables()->time(i);
      times.add({std::llround(1e9 * time.wall), std::llround(1e9 * time.cpu)});
    }
}

/// An error after some ticks: says that the trace holds them, if it does.
tl::unexpected<Failure> refuse_after(Failure failure, const SimRun& run, const Report& report) {
  const std::uint64_t ticks = report.ticks.count();
  if (run.output.stays() && ticks > 0) {
    failure.remedy += fmt::format("{}{} holds the {} before the error.", failure.remedy.empty() ? "" : " ", run.output.path(),
                                  counted(ticks, "tick"));
  }
  return tl::unexpected(std::move(failure));
}

Outcome finish(SimRun& run, const SimOptions& options) {
  if (const auto done = run.trace.finish(); !done) return refuse(options.output, done.error());
  if (run.stream) {
    if (const auto done = run.stream->writer.finish(); !done) return refuse(options.stream, done.error());
    TACTUS_CHECK(run.stream->file.keep());
  }
  return run.output.keep();
}

}  // namespace

Outcome simulate(SimRun& run, std::int64_t ticks, const SimOptions& options, Report& report) {
  Progress progress("sim", static_cast<std::uint64_t>(ticks), options.common.progress());
  const StopOnSignal stop;
  for (std::int64_t i = 0; i < ticks && StopOnSignal::caught() == 0; ++i) {
    if (run.recording) {
      const auto more = next_frame(*run.recording, run.recorded, options.replay);
      if (!more) return refuse_after(more.error(), run, report);
      if (!*more) {
        TACTUS_CHECK(check_ending(options.replay, *run.recording, report.ticks.count()));
        break;
      }
    }
    if (!run.checks.empty()) run.checked.begin(run.simulation);
    const auto packet = step(run, options, report.timings[0].times);
    if (!packet) return refuse_after(packet.error(), run, report);
    if (report.timings.size() > 1) add_deformations(run, report.timings[1].times);
    TACTUS_CHECK(record(run, *packet, options, report));
    if (!run.checks.empty()) run.checked.end(run.simulation.frame());
    for (SimCheck& check : run.checks) TACTUS_CHECK(check.add(run.checked));
    progress.update(report.ticks.count());
  }
  return finish(run, options);
}

}  // namespace tactus::cli
