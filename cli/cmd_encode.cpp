// SPDX-License-Identifier: Apache-2.0
#include "cli/cmd_encode.h"

#include <algorithm>
#include <optional>

#include <tactus/base/shown.h>
#include <tactus/trace/trace_file.h>
#include "cli/option_needs.h"
#include "cli/report.h"
#include "cli/trace_ending.h"

namespace tactus::cli {
namespace {

struct EncodeOptions {
  std::string input, output;
  TriggerArguments triggers;
  MeshArguments meshes;
  CommonOptions common;
};

/// Rigid objects on their way: encoder and, beside it, the decoder that proves what a client sees.
struct RigidLink {
  RigidEncoder encoder;
  RigidDecoder decoder;
  Replica replica;
  std::vector<Contact> contacts;
  std::vector<Pose> shown;
};

struct Session {
  StreamFileWriter writer;
  PartJoiner parts;
  std::optional<RigidLink> rigid;  // none: nothing rigid can move
  std::vector<DeformableLink> meshes;
};

bool has_moving(const TraceInfo& info) {
  return std::ranges::any_of(info.objects, [](const TraceObject& o) { return o.dof != Dof::none; });
}

Result<Session> start(const TraceInfo& info, const TraceFrame& first, const EncodeOptions& options, std::ostream& out) {
  TACTUS_TRY(StreamHeader header, stream_header(info, first, options.meshes.coding()));
  header.bounds = bounds_of(header, options.triggers.triggers(), options.meshes.thresholds(options.triggers));
  TACTUS_TRY(StreamFileWriter writer, StreamFileWriter::create(out, header));
  Session session{std::move(writer), PartJoiner(header), std::nullopt, {}};
  if (has_moving(info) || info.meshes.empty()) {
    TACTUS_TRY(RigidEncoder encoder, RigidEncoder::create(header, options.triggers.encoder()));
    TACTUS_TRY(RigidDecoder decoder, RigidDecoder::create(header));
    TACTUS_TRY(Replica replica, Replica::create(header));
    session.rigid.emplace(RigidLink{std::move(encoder), std::move(decoder), std::move(replica),
                                    std::vector<Contact>(info.users.size()), std::vector<Pose>(info.objects.size())});
  }
  for (std::size_t i = 0; i < header.meshes.size(); ++i) {
    TACTUS_TRY(DeformableLink link, DeformableLink::create(header, i, options.meshes.encoder(options.triggers)));
    session.meshes.push_back(std::move(link));
  }
  return session;
}

Result<void> encode_rigid(Session& s, const TraceFrame& frame, Report& report) {
  RigidLink& link = *s.rigid;
  for (std::size_t i = 0; i < frame.users.size(); ++i) link.contacts[i] = frame.users[i].contact;
  TACTUS_TRY(const EncodedPacket packet,
             report.timings[0].times.measure([&] { return link.encoder.encode(frame.tick, frame.objects, link.contacts); }));
  if (!packet.bytes.empty()) {
    const auto bytes = s.parts.join(0, packet.bytes);
    TACTUS_CHECK(s.writer.add(frame.tick, bytes, packet.key));
    report.traffic->add(packet.reason, packet.updates, bytes.size(), packet.key);
    TACTUS_TRY(const DecodedPacket decoded, report.timings[1].times.measure([&] { return link.decoder.decode(packet.bytes); }));
    link.replica.apply(decoded, link.decoder.objects(), frame.tick);
  }
  for (std::uint32_t i = 0; i < link.shown.size(); ++i)
    link.shown[i] = to_pose(link.replica.pose(i, frame.tick), link.decoder.header().grid);
  report.fidelity->add(frame, link.shown);
  return {};
}

Result<void> encode_frame(Session& s, const TraceFrame& frame, Report& report) {
  if (s.rigid) TACTUS_CHECK(encode_rigid(s, frame, report));
  for (std::size_t i = 0; i < s.meshes.size(); ++i) {
    if (!frame.meshes[i].updated) continue;
    TACTUS_TRY(const DeformablePackets packets, transmit(s.meshes[i], frame, i, report.meshes[i]));
    ++report.meshes[i].traffic->frames;
    for (const EncodedDeformablePacket& packet : packets) {
      if (packet.bytes.empty()) continue;
      const auto bytes = s.parts.join(i + 1, packet.bytes);
      TACTUS_CHECK(s.writer.add(frame.tick, bytes, packet.key));
      report.meshes[i].traffic->add(bytes.size(), packet.updates, packet.key, packet.half);
    }
  }
  report.ticks.add(frame.tick);
  return {};
}

/// The trace is to blame for what its objects do, the output for bytes that it does not take.
const std::string& to_blame(const Error& error, const EncodeOptions& options) {
  return error.code == Errc::io ? options.output : options.input;
}

Outcome encode_all(TraceReader& reader, Session& session, TraceFrame& frame, const EncodeOptions& options, Report& report) {
  Progress progress("encode", reader.frame_count(), options.common.progress());
  while (true) {
    if (const auto done = encode_frame(session, frame, report); !done) {
      return refuse(to_blame(done.error(), options), place_of_tick(frame.tick), done.error());
    }
    progress.update(report.ticks.count());
    const auto more = reader.next(frame);
    if (!more) return refuse(options.input, more.error());
    if (!*more) break;
  }
  if (const auto done = session.writer.finish(); !done) return refuse(options.output, done.error());
  return {};
}

Outcome run(const EncodeOptions& options) {
  if (auto fits = check_no_terminal(options.output); !fits) return fits;
  auto reader = TraceReader::open(options.input);
  if (!reader) return refuse(options.input, reader.error());
  TraceFrame frame;
  const auto any = reader->next(frame);
  if (!any) return refuse(options.input, any.error());
  if (!*any) {
    if (auto whole = check_ending(options.input, *reader, 0); !whole) return whole;
    return refuse(shown_path(options.input) + ": the trace has no frames", "Record or simulate at least one tick.");
  }
  note_idle_options(*options.common.command, subjects_of(reader->info()), "trace");
  auto output = OutputFile::create(options.output, options.common.existing(), {options.input});
  if (!output) return tl::unexpected(output.error());
  const auto stream = output->open();
  if (!stream) return tl::unexpected(stream.error());

  auto session = start(reader->info(), frame, options, **stream);
  if (!session) return refuse(to_blame(session.error(), options), session.error());
  Report report{.command = "encode", .files = {{"trace", options.input}, {"stream", options.output}}};
  report.describe(reader->info());
  if (session->rigid) {
    report.traffic.emplace();
    report.fidelity.emplace(reader->info(), options.triggers.triggers());
    report.timings = {{"encode", "encode, per tick"}, {"decode", "decode, per packet"}};
  }
  add_meshes(reader->info(), options.meshes, options.triggers, report);
  for (MeshReport& mesh : report.meshes) mesh.promised = options.meshes.coding().profile == DeformableProfile::main;
  if (auto done = encode_all(*reader, *session, frame, options, report); !done) return done;
  if (auto whole = check_ending(options.input, *reader, report.ticks.count()); !whole) return whole;
  if (reader->cut_short()) report.warnings.emplace_back("the trace ends without its index; everything up to there was encoded");
  if (auto kept = output->keep(); !kept) return kept;
  report.stream = {session->writer.header_bytes(), session->writer.bytes()};
  report.bounds_from = options.triggers.any_given() || options.meshes.any_given() ? "options" : "defaults";
  print(report, options.common, beside(options.output));
  return verdict(report, options.output);
}

}  // namespace

void setup_encode(Command& app, Action& action) {
  auto options = std::make_shared<EncodeOptions>();
  Command& command = app.add_command("encode", "Turn a trace into a stream of packets");
  command.add_option("TRACE", options->input, "Trace to encode (MCAP), - is standard input")->type_name("")->required();
  command.add_option("-o,--output", options->output, "Stream to write, - is standard output")->required()->type_name("FILE");
  options->triggers.add_to(command);
  options->triggers.add_encoder_to(command);
  options->meshes.add_to(command);
  options->meshes.add_encoder_to(command);
  add_output_options(command, options->common);
  command.footer(
      "Examples:\n"
      "  tactus encode push.mcap -o push.tct -p 4% --visual 6mm,2deg\n"
      "  tactus encode tosses.mcap -o tosses.tct --visual 5mm,4deg --haptic off\n"
      "  tactus encode membrane.mcap -o membrane.tct -p 2.5% --mesh-visual 0.25mm --basis 48");
  on_chosen<EncodeOptions>(command, action, options, run);
}

}  // namespace tactus::cli
