// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <tactus/base/shown.h>
#include <tactus/file/stream_file.h>
#include <tactus/receiver.h>
#include <tactus/thesis/if_built.h>
#include <tactus/trace/trace_file.h>
#include <tactus/trace/trace_scene.h>
#include "cli/commands/input.h"
#include "cli/figure/time_figure.h"
#include "cli/options/contact_option.h"
#include "cli/options/option_needs.h"
#include "cli/report/held_log.h"
#include "cli/report/report.h"

namespace tactus::cli {
namespace {

struct EncodeOptions {
  std::string input, output, plot;
  TriggerArguments triggers;
  MeshArguments meshes;
  MotionArguments motion;
  ContactArguments contacts;
  unsigned clusters = 0;
  double world_size = 0;  // [m], 0: not given
  CommonOptions common;
};

/// A sender and, beside it, the receiver that proves what a client sees.
struct Session {
  StreamFileWriter writer;
  Sender sender;
  Receiver receiver;
  FrameTruth truth;
  std::vector<Pose> shown;
  std::optional<ErrorFigure> figure{};
  HeldLog held{};
};

constexpr const char* kReasons[] = {"key or unconditional", "heartbeat", "visual bound", "haptic bound"};  // index: Reason

using Clusters = std::map<std::string, ClusterBasis>;

/// Those of all meshes, for which the trace is read once more.
tl::expected<Clusters, Failure> clusters_of(const std::string& path, const EncodeOptions& options) {
  if (options.clusters == 0) return Clusters{};
  auto reader = open_trace(path, options.input, options.common.progress());
  if (!reader) return tl::unexpected(reader.error());
  auto found = find_clusters(*reader, options.clusters);
  if (!found) return refuse(options.input, found.error());
  return std::move(*found);
}

bool has_moving(const TraceInfo& info) {
  return std::ranges::any_of(info.objects, [](const TraceObject& o) { return o.dof != Dof::none; });
}

/// The file that an error message names: the output for write errors, else the trace.
const std::string& to_blame(const Error& error, const EncodeOptions& options) {
  return error.code == Errc::io ? options.output : options.input;
}

/// Why a scene could not be made, with its figures.
tl::unexpected<Failure> refuse_scene(const SceneFinding& finding, const EncodeOptions& options) {
  auto refused = refuse(options.input, shown(finding.object), finding.error);
  if (!finding.detail.empty()) refused.value().text += ": " + finding.detail;
  if (finding.error.rule == std::string_view("R-API-2"))
    refused.value().remedy =
        "Give the size of the world with --tune world_size=..., or check the unit (import takes --length-unit).";
  if (finding.detail.starts_with("gravity")) refused.value().remedy = "Give a smaller gravity or friction.";
  else if (!finding.detail.empty() && finding.error.rule == std::string_view("R-API-4"))
    refused.value().remedy = "Give a smaller world_size, or wider bounds.";
  return refused;
}

tl::expected<Session, Failure> start(const TraceInfo& info, const TraceFrame& first, const EncodeOptions& options,
                                     Clusters clusters, std::ostream& out) {
  const auto blame = [&](const Error& error) { return refuse(to_blame(error, options), error); };
  TraceCoding coding = options.meshes.coding(options.triggers);
  coding.clusters = std::move(clusters);
  const SenderOptions wanted = options.meshes.sender(options.triggers);
  auto builder = scene_builder(info, first, coding, wanted);
  if (!builder) return blame(builder.error());
  if (options.world_size > 0) builder->world_size(options.world_size);
  const auto scene = builder->motion(options.motion.physics()).build({.thesis = thesis_if_built()});
  if (!scene) return refuse_scene(scene.error(), options);
  auto writer = StreamFileWriter::create(out, **scene);
  if (!writer) return blame(writer.error());
  auto sender = Sender::create(*scene, wanted);
  if (!sender) return blame(sender.error());
  auto receiver = Receiver::create(*scene);
  if (!receiver) return blame(receiver.error());
  return Session{*std::move(writer), *std::move(sender), *std::move(receiver), FrameTruth(info),
                 std::vector<Pose>(info.objects.size())};
}

Result<void> send(Session& s, const Packet& packet, std::int64_t tick, Report& report) {
  TACTUS_CHECK(s.writer.add(tick, packet.number, packet.bytes, packet.key));
  const auto decode = [&] { return s.receiver.push(packet.number, packet.bytes); };
  if (s.figure) {
    const bool is_rigid = packet.substream == 0;
    const std::string line =
        is_rigid ? kReasons[static_cast<std::size_t>(packet.reason)] : report.meshes[packet.substream - 1].name;
    s.figure->add_packet(tick, line, packet.bytes.size());
  }
  if (packet.substream == 0) {
    report.traffic->add(packet.reason, packet.updates, packet.bytes.size(), packet.key);
    TACTUS_CHECK(report.timings[1].times.measure(decode));
  } else {
    MeshReport& mesh = report.meshes[packet.substream - 1];
    mesh.traffic->add(packet.bytes.size(), packet.updates, packet.key, packet.layer);
    TACTUS_CHECK(mesh.decode.measure(decode));
  }
  return {};
}

/// Holds what the client shows in this tick against the truth.
void judge(Session& s, const TraceFrame& frame, Report& report) {
  Replica& replica = s.receiver.replica();
  for (std::uint32_t i = 0; i < s.shown.size(); ++i) s.shown[i] = s.receiver.pose(i, frame.tick);
  if (report.fidelity) report.fidelity->add(frame, s.shown);
  if (s.figure) s.figure->add(frame, s.shown);
  for (std::size_t i = 0; i < frame.meshes.size(); ++i) {
    if (!frame.meshes[i].updated) continue;
    ++report.meshes[i].traffic->frames;
    const auto displacements = replica.displacements(i, frame.tick);
    report.meshes[i].fidelity->add(frame.meshes[i].displacements, displacements, touch_of(frame, i));
    if (s.figure) s.figure->add_shape(frame, i, displacements, s.receiver.scene()->grid.position);
  }
}

/// A tick with a new shape is timed for that deformable object, any other tick for the rigid objects. Without rigid objects, ticks
/// without a new shape are skipped.
StepTimes* times_of(const TraceFrame& frame, Report& report) {
  for (std::size_t i = 0; i < frame.meshes.size(); ++i)
    if (frame.meshes[i].updated) return &report.meshes[i].encode;
  return report.timings.empty() ? nullptr : &report.timings[0].times;
}

Result<void> encode_frame(Session& s, const TraceFrame& frame, Report& report) {
  if (StepTimes* times = times_of(frame, report)) {
    const Truth truth = s.truth.of(frame);
    TACTUS_TRY(const auto packets, times->measure([&] { return s.sender.encode(frame.tick, truth); }));
    s.held.look(frame.tick, s.sender.held());
    for (const Packet& packet : packets) TACTUS_CHECK(send(s, packet, frame.tick, report));
  }
  judge(s, frame, report);
  report.ticks.add(frame.tick);
  return {};
}

Outcome encode_all(TraceReader& reader, Session& session, TraceFrame& frame, const ContactDeclarations& contacts,
                   const EncodeOptions& options, Report& report) {
  ReadProgress progress("encode", &reader, options.common.progress());
  while (true) {
    contacts.apply(frame);
    if (const auto done = encode_frame(session, frame, report); !done) {
      return refuse(to_blame(done.error(), options), location_of_tick(frame.tick), done.error());
    }
    progress.update(report.ticks.count());
    TACTUS_TRY(const bool more, next_frame(reader, frame, options.input));
    if (!more) break;
  }
  if (const auto done = session.writer.finish(); !done) return refuse(options.output, done.error());
  return {};
}

Outcome run_encode(const EncodeOptions& options) {
  TACTUS_CHECK(check_no_terminal(options.output));
  std::optional<RereadableInput> again;
  if (options.clusters > 0) {
    TACTUS_TRY(again, RereadableInput::open(options.input));
  }
  const std::string& path = again ? again->path() : options.input;
  auto reader = open_trace(path, options.input, options.common.progress());
  if (!reader) return tl::unexpected(reader.error());
  TraceFrame frame;
  TACTUS_TRY(const bool any, next_frame(*reader, frame, options.input));
  if (!any) {
    TACTUS_CHECK(check_ending(options.input, *reader, 0));
    return refuse(shown_path(options.input) + ": the trace has no frames", "Record or simulate at least one tick.");
  }
  TACTUS_TRY(const ContactDeclarations contacts, options.contacts.of(reader->info(), options.input));
  note_idle_options(*options.common.command, subjects_of(reader->info()), "trace");
  TACTUS_CHECK(check_plot_option(options.plot, options.common, {options.input, options.output}));
  TACTUS_TRY(Clusters clusters, clusters_of(path, options));
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input, options.plot}));
  TACTUS_TRY(const auto stream, output.open());

  auto session = start(reader->info(), frame, options, std::move(clusters), *stream);
  if (!session) return tl::unexpected(session.error());
  if (!options.plot.empty()) session->figure.emplace(reader->info());
  Report report{.command = "encode", .files = {{"trace", options.input}, {"stream", options.output}}};
  report.describe(reader->info());
  if (has_moving(reader->info()) || reader->info().meshes.empty()) {
    report.traffic.emplace();
    report.fidelity.emplace(reader->info(), options.triggers.triggers());
    report.timings = {{"encode"}, {"decode"}};
  }
  add_meshes(reader->info(), options.meshes, options.triggers, report);
  for (MeshReport& mesh : report.meshes) mesh.guaranteed = options.meshes.is_main();
  TACTUS_CHECK(encode_all(*reader, *session, frame, contacts, options, report));
  TACTUS_CHECK(check_ending(options.input, *reader, report.ticks.count()));
  report.add(reader->notes());
  if (reader->cut_short())
    report.warnings.emplace_back("the trace ends without its index; everything before the cut was encoded");
  for (const std::string& line : session->held.lines(*session->sender.scene())) report.warnings.push_back(line);
  TACTUS_CHECK(output.keep());
  report.stream = {session->writer.header_bytes(), session->writer.bytes()};
  report.bounds_from = options.triggers.any_given() || options.meshes.any_given() ? "options" : "defaults";
  if (session->figure)
    TACTUS_CHECK(
        draw(options.plot,
             Figure{"Encoded: " + std::filesystem::path(options.input).filename().string(), session->figure->panels(report)},
             options.common));
  note_idle_deadband(*options.common.command, report);
  print(report, options.common, beside(options.output));
  return verdict(report, options.output);
}

}  // namespace

void setup_encode(Command& app, Action& action) {
  auto options = std::make_shared<EncodeOptions>();
  Command& command = app.add_command("encode", "Encode a trace into a stream of packets");
  command.add_option("TRACE", options->input, "Trace to encode (MCAP), - is standard input")->type_name("")->required();
  command.add_option("-o,--output", options->output, "Stream to write, - is standard output")->required()->type_name("FILE");
  add_encoder_options(command, options->triggers, options->meshes);
  command
      .add_option(key("clusters"), options->clusters,
                  "Clusters of vertices that move alike, as the basis of bodies that turn and walk; 0: none. The trace is read "
                  "twice for it, one from a pipe from a temporary copy (--profile main) [0]")
      ->check(whole_number(0, ClusterBasis::kMaxClusters))
      ->type_name("N")
      ->excludes(command.find("--basis"));
  add_quantity(command, key("world_size"), options->world_size, Dimension::length,
               "How far from the origin positions get, along any axis: the position grid is as fine as that permits [512m]")
      ->check(above_zero(Dimension::length));
  options->motion.add_to(command);
  options->contacts.add_to(command);
  add_plot_option(command, options->plot, "packets by their reasons and errors beside their bounds, over time");
  add_output_options(command, options->common);
  command.footer(
      "Examples:\n"
      "  tactus encode push.mcap -o push.tct -p 8% --visual 6mm,2deg\n"
      "  tactus encode arm.mcap -o arm.tct -p 4% --contact hand=cup,k=500N/m\n"
      "  tactus encode tosses.mcap -o tosses.tct --visual 5mm,4deg --haptic off --tune gravity=9.81,friction=0.25\n"
      "  tactus encode membrane.mcap -o membrane.tct -p 2.5% --deformable-visual 0.25mm --basis 48 --plot membrane.svg\n"
      "  tactus encode dance.mcap -o dance.tct --haptic off --deformable-visual 1mm --tune clusters=40");
  on_chosen<EncodeOptions>(command, action, options, run_encode);
}

}  // namespace tactus::cli
