// SPDX-License-Identifier: Apache-2.0
#include "cli/cmd_compare.h"

#include <fmt/format.h>

#include "cli/report.h"
#include "codec/trace/trace_file.h"

namespace tactus::cli {
namespace {

struct CompareOptions {
  std::string truth, replica;
  TriggerArguments triggers;
  MeshArguments meshes;
  CommonOptions common;
};

Outcome check_same_scene(const CompareOptions& options, const TraceInfo& truth, const TraceInfo& replica) {
  const auto differ = [&](const std::string& what) {
    return refuse(options.replica + ": " + what + " as in " + options.truth,
                  "Compare a trace with the replica that was decoded from its own stream.");
  };
  if (truth.tick_rate != replica.tick_rate)
    return differ(fmt::format("the tick rate is {} Hz, not {} Hz", replica.tick_rate, truth.tick_rate));
  if (truth.objects.size() != replica.objects.size()) {
    return differ(fmt::format("there are {} objects, not {}", replica.objects.size(), truth.objects.size()));
  }
  for (std::size_t i = 0; i < truth.objects.size(); ++i) {
    if (truth.objects[i].name != replica.objects[i].name) {
      return differ(fmt::format("object {} is \"{}\", not \"{}\"", i, replica.objects[i].name, truth.objects[i].name));
    }
  }
  if (truth.meshes.size() != replica.meshes.size())
    return differ(fmt::format("there are {} meshes, not {}", replica.meshes.size(), truth.meshes.size()));
  for (std::size_t i = 0; i < truth.meshes.size(); ++i) {
    const TraceMesh &a = truth.meshes[i], &b = replica.meshes[i];
    if (a.name != b.name) return differ(fmt::format("mesh {} is \"{}\", not \"{}\"", i, b.name, a.name));
    if (a.rest.vertices.size() != b.rest.vertices.size() || a.rest.triangles != b.rest.triangles)
      return differ(fmt::format("mesh \"{}\" does not have the same vertices and triangles", a.name));
  }
  return {};
}

/// What the replica shows, of which every tick brings only what is new.
struct Shown {
  std::vector<Pose> poses;
  std::vector<std::vector<Vec3>> shapes;  // displacements

  explicit Shown(const TraceInfo& info) : poses(info.objects.size()) {
    for (const TraceMesh& mesh : info.meshes) shapes.emplace_back(mesh.rest.vertices.size());
  }
  void take(const TraceFrame& frame) {
    for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = frame.objects[i].pose;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      if (!frame.meshes[i].updated) continue;
      const float* u = frame.meshes[i].displacements.data();
      for (Vec3& vertex : shapes[i]) vertex = {u[0], u[1], u[2]}, u += 3;
    }
  }
};

void add(const TraceFrame& truth, const Shown& shown, Report& report) {
  report.fidelity->add(truth, shown.poses);
  for (std::size_t i = 0; i < shown.shapes.size(); ++i)
    if (truth.meshes[i].updated)
      report.meshes[i].fidelity->add(truth.meshes[i].displacements, shown.shapes[i], touch_of(truth, i));
}

/// Both traces side by side; ticks that only one of them has are passed over.
/// out  number of the truth's ticks that the replica lacks
tl::expected<std::uint64_t, Failure> compare_all(TraceReader& truth, TraceReader& replica, const CompareOptions& options,
                                                 Report& report) {
  Progress progress("compare", truth.frame_count(), options.common.progress());
  std::uint64_t unmatched = 0;
  TraceFrame frame, next_shown;
  Shown shown(truth.info());
  bool more = true;
  next_shown.tick = -1;
  while (true) {
    const auto next = truth.next(frame);
    if (!next) return refuse(options.truth, next.error());
    if (!*next) return unmatched;
    while (more && next_shown.tick < frame.tick) {
      const auto advanced = replica.next(next_shown);
      if (!advanced) return refuse(options.replica, advanced.error());
      more = *advanced;
      if (more) shown.take(next_shown);
    }
    if (!more || next_shown.tick != frame.tick) {
      ++unmatched;
      continue;
    }
    report.timings[0].times.measure([&] { return add(frame, shown, report), true; });
    progress.update(++report.ticks);
  }
}

Outcome run(const CompareOptions& options) {
  auto truth = TraceReader::open(options.truth);
  if (!truth) return refuse(options.truth, truth.error());
  auto replica = TraceReader::open(options.replica);
  if (!replica) return refuse(options.replica, replica.error());
  if (auto same = check_same_scene(options, truth->info(), replica->info()); !same) return same;

  Report report{.command = "compare", .files = {{"truth", options.truth}, {"replica", options.replica}}};
  report.describe(truth->info());
  report.fidelity.emplace(truth->info(), options.triggers.triggers());
  for (const TraceMesh& mesh : truth->info().meshes)
    report.meshes.push_back({.name = mesh.name,
                             .vertices = mesh.rest.vertices.size(),
                             .fidelity = MeshFidelity(mesh.rest, options.meshes.thresholds(options.triggers),
                                                      options.meshes.rings(), GridExponents{}.position)});
  report.timings = {{"compare, per tick", {}}};
  const auto unmatched = compare_all(*truth, *replica, options, report);
  if (!unmatched) return tl::unexpected(unmatched.error());
  if (report.ticks == 0)
    return refuse(options.replica + ": shares no tick with " + options.truth, "Decode with --like " + options.truth + ".");
  if (*unmatched > 0) {
    report.notes.emplace_back(
        "warning", fmt::format("{} of {} ticks are not in the replica and were left out; decode with --like {}", *unmatched,
                               *unmatched + report.ticks, options.truth));
  }
  print(report, options.common, Destination::standard_output);
  return {};
}

}  // namespace

void setup_compare(CLI::App& app, Action& action) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App& command = *app.add_subcommand("compare", "Hold a replica against the truth");
  command.add_option("TRUTH", options->truth, "What truly happened (MCAP)")->type_name("")->required();
  command.add_option("REPLICA", options->replica, "What a client showed (MCAP)")->type_name("")->required();
  options->triggers.add_to(command);
  options->meshes.add_to(command);
  add_report_options(command, options->common);
  command.footer(
      "Ticks over a bound are counted; give the bounds that the stream was encoded with.\n"
      "Example:\n"
      "  tactus compare push.mcap replica.mcap -p 4% --visual 6mm,2deg");
  on_chosen<CompareOptions>(command, action, options, run);
}

}  // namespace tactus::cli
