// SPDX-License-Identifier: Apache-2.0
#include "cli/cmd_encode.h"

#include <fmt/format.h>

#include "cli/report.h"
#include "codec/trace/trace_file.h"

namespace tactus::cli {
namespace {

struct EncodeOptions {
  std::string input, output;
  TriggerArguments triggers;
  CommonOptions common;
};

/// The stream being written and, beside it, the decoder that proves what a client sees.
struct Session {
  RigidEncoder encoder;
  RigidDecoder decoder;
  Replica replica;
  StreamFileWriter writer;
  std::vector<Contact> contacts;
  std::vector<Pose> shown;
};

Result<Session> start(const TraceInfo& info, const TraceFrame& first, const RigidEncoderOptions& options, std::ostream& out) {
  TACTUS_TRY(const StreamHeader header, stream_header(info, first));
  TACTUS_TRY(RigidEncoder encoder, RigidEncoder::create(header, options));
  TACTUS_TRY(RigidDecoder decoder, RigidDecoder::create(header));
  TACTUS_TRY(Replica replica, Replica::create(header));
  TACTUS_TRY(StreamFileWriter writer, StreamFileWriter::create(out, header));
  return Session{std::move(encoder),
                 std::move(decoder),
                 std::move(replica),
                 std::move(writer),
                 std::vector<Contact>(info.users.size()),
                 std::vector<Pose>(info.objects.size())};
}

Result<void> encode_frame(Session& s, const TraceFrame& frame, Report& report) {
  for (std::size_t i = 0; i < frame.users.size(); ++i) s.contacts[i] = frame.users[i].contact;
  TACTUS_TRY(const EncodedPacket packet,
             report.timings[0].times.measure([&] { return s.encoder.encode(frame.tick, frame.objects, s.contacts); }));
  if (!packet.bytes.empty()) {
    TACTUS_CHECK(s.writer.add(frame.tick, packet.bytes, packet.key));
    report.traffic->add(packet.reason, packet.updates, packet.bytes.size(), packet.key);
    TACTUS_TRY(const DecodedPacket decoded, report.timings[1].times.measure([&] { return s.decoder.decode(packet.bytes); }));
    s.replica.apply(decoded, s.decoder.objects(), frame.tick);
  }
  for (std::uint32_t i = 0; i < s.shown.size(); ++i) s.shown[i] = to_pose(s.replica.pose(i, frame.tick), s.decoder.header().grid);
  report.fidelity->add(frame, s.shown);
  ++report.ticks;
  return {};
}

Outcome encode_all(TraceReader& reader, Session& session, TraceFrame& frame, const EncodeOptions& options, Report& report) {
  Progress progress("encode", reader.frame_count(), options.common.progress());
  while (true) {
    if (const auto done = encode_frame(session, frame, report); !done) {
      return refuse(options.input, place_of_tick(frame.tick), done.error());
    }
    progress.update(report.ticks);
    const auto more = reader.next(frame);
    if (!more) return refuse(options.input, more.error());
    if (!*more) break;
  }
  if (const auto done = session.writer.finish(); !done) return refuse(options.output, done.error());
  return {};
}

Outcome run(const EncodeOptions& options) {
  auto reader = TraceReader::open(options.input);
  if (!reader) return refuse(options.input, reader.error());
  TraceFrame frame;
  const auto any = reader->next(frame);
  if (!any) return refuse(options.input, any.error());
  if (!*any) return refuse(options.input + ": the trace has no frames", "Record or simulate at least one tick.");
  auto output = OutputFile::create(options.output, options.common.existing(), {options.input});
  if (!output) return tl::unexpected(output.error());
  const auto stream = output->open();
  if (!stream) return tl::unexpected(stream.error());

  const RigidEncoderOptions encoder = options.triggers.encoder();
  auto session = start(reader->info(), frame, encoder, **stream);
  if (!session) return refuse(options.input, session.error());
  Report report{.command = "encode", .files = {{"trace", options.input}, {"stream", options.output}}};
  report.describe(reader->info());
  if (!reader->info().meshes.empty())
    report.notes.emplace_back("meshes",
                              fmt::format("{} in the trace, not coded yet: rigid objects only", reader->info().meshes.size()));
  report.traffic.emplace();
  report.fidelity.emplace(reader->info(), encoder.triggers);
  report.timings = {{"encode, per tick", {}}, {"decode, per packet", {}}};
  if (auto done = encode_all(*reader, *session, frame, options, report); !done) return done;
  if (reader->cut_short())
    report.notes.emplace_back("warning", "the trace ends without its index; everything up to there was encoded");
  if (auto kept = output->keep(); !kept) return kept;
  print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_encode(CLI::App& app, Action& action) {
  auto options = std::make_shared<EncodeOptions>();
  CLI::App& command = *app.add_subcommand("encode", "Turn a trace into a stream of packets");
  command.add_option("TRACE", options->input, "Trace to encode (MCAP), - is standard input")->type_name("")->required();
  command.add_option("-o,--output", options->output, "Stream to write, - is standard output")->required()->type_name("FILE");
  options->triggers.add_to(command);
  options->triggers.add_encoder_to(command);
  add_output_options(command, options->common);
  command.footer(
      "Examples:\n"
      "  tactus encode push.mcap -o push.tct -p 4% --visual 6mm,2deg\n"
      "  tactus encode tosses.mcap -o tosses.tct --visual 5mm,4deg --haptic off");
  on_chosen<EncodeOptions>(command, action, options, run);
}

}  // namespace tactus::cli
