// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include <tactus/base/shown.h>
#include <tactus/trace/mcap_reader.h>
#include <tactus/trace/mcap_writer.h>
#include <tactus/trace/trace_file.h>
#include "cli/commands/input.h"
#include "cli/report/notes.h"
#include "cli/report/report.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

struct RecoverOptions {
  std::string input, output;
  std::string readable;  // where to read it
  CommonOptions common;
};

std::string seconds(std::uint64_t time) { return fmt::format("{:.3f} s", 1e-9 * static_cast<double>(time)); }

/// "byte 1234: a check value does not match (R-TRC-6), 51200 bytes, log time 1.000 s to 1.999 s"
std::string loss_text(const ReadLoss& loss) {
  std::string text = loss.file.empty() ? "" : shown(loss.file) + ", ";
  text += fmt::format("byte {}: {} ({})", loss.cause.bit_offset / 8, describe(loss.cause), loss.cause.rule);
  if (loss.bytes > 0) text += fmt::format("; {} bytes", loss.bytes);
  if (loss.from && loss.until && *loss.from == *loss.until) text += "; at log time " + seconds(*loss.from);
  else if (loss.from && loss.until) text += "; log time " + seconds(*loss.from) + " to " + seconds(*loss.until);
  else if (loss.from) text += "; after log time " + seconds(*loss.from);
  return text;
}

/// The losses, the first ones in words. Neighbours at one place are named once.
void add_losses(const std::vector<ReadLoss>& losses, Report& report) {
  constexpr std::size_t kMost = 20;
  std::uint64_t bytes = 0;
  for (std::size_t i = 0; i < losses.size(); ++i) {
    bytes += losses[i].bytes;
    if (i < kMost) report.warnings.push_back("lost: " + loss_text(losses[i]));
  }
  if (losses.size() > kMost)
    report.warnings.push_back(fmt::format("lost: and {} more places; {} bytes in all", losses.size() - kMost, bytes));
}

/// Objects that say nothing new right after a gap are shown where they were before it.
class Held {
 public:
  explicit Held(const TraceInfo& info) : info_(info), since_(info.objects.size()) {}

  void look(const TraceFrame& frame, std::size_t losses, std::size_t before) {
    // The reader is ahead by a message: the gap is before this frame or before the next one.
    const bool is_behind_gap = losses > before || std::exchange(may_follow_, false);
    may_follow_ = losses > before;
    if (is_behind_gap && !last_.empty())
      for (std::size_t i = 0; i < last_.size(); ++i)
        if (info_.objects[i].dof != Dof::none && !since_[i]) since_[i] = frame.tick;
    for (std::size_t i = 0; i < last_.size(); ++i)
      if (since_[i] && !is_same(frame.objects[i], last_[i])) end(i, frame.tick);
    last_ = frame.objects;
  }
  std::vector<std::string> finish(std::int64_t last_tick) {
    for (std::size_t i = 0; i < since_.size(); ++i)
      if (since_[i]) end(i, last_tick + 1);
    return std::move(lines_);
  }

 private:
  static bool is_same(const RigidSample& a, const RigidSample& b) {
    return a.pose.position == b.pose.position && a.pose.rotation == b.pose.rotation && a.velocity == b.velocity &&
           a.angular_velocity == b.angular_velocity;
  }
  void end(std::size_t i, std::int64_t tick) {
    if (tick > *since_[i])
      lines_.push_back(
          fmt::format("object {}: nothing new from tick {} to {}, behind what was lost; it stands where it was before",
                      shown(info_.objects[i].name), *since_[i], tick - 1));
    since_[i].reset();
  }
  const TraceInfo& info_;
  std::vector<std::optional<std::int64_t>> since_;
  std::vector<RigidSample> last_;
  bool may_follow_ = false;
  std::vector<std::string> lines_;
};

/// What can be read, and why the rest cannot.
struct Rescue {
  std::optional<Diagnostic> damage{};
  bool cut_short = false;
};

tl::expected<Rescue, Failure> copy(TraceReader& reader, TraceWriter& writer, const RecoverOptions& options, Report& report) {
  Progress progress("recover", reader.frame_count(), options.common.progress());
  TraceFrame frame;
  Held held(reader.info());
  std::size_t losses = 0;
  Rescue rescue;
  for (;;) {
    const auto more = report.timings[0].times.measure([&] { return reader.next(frame); });
    if (!more) rescue.damage = reader.explain(more.error());
    else if (!*more) rescue.cut_short = reader.cut_short();
    if (!more || !*more) break;
    if (const auto written = writer.write(frame); !written)
      return refuse(options.output, location_of_tick(frame.tick), written.error());
    const std::vector<ReadLoss>& lost = reader.losses();
    const auto now = static_cast<std::size_t>(
        std::count_if(lost.begin(), lost.end(), [](const ReadLoss& loss) { return loss.from.has_value(); }));
    held.look(frame, now, losses);
    losses = now;
    report.ticks.add(frame.tick);
    progress.update(report.ticks.count());
  }
  for (std::string& text : held.finish(report.ticks.last())) report.warnings.push_back(std::move(text));
  return rescue;
}

/// What was written is what was read.
Outcome read_back(const std::string& path, const RecoverOptions& options, const TickSpan& ticks) {
  auto reader = open_trace(path, options.output, options.common.progress());
  if (!reader) return tl::unexpected(reader.error());
  TraceFrame frame;
  TickSpan read;
  for (;;) {
    TACTUS_TRY(const bool more, next_frame(*reader, frame, options.output));
    if (!more) break;
    read.add(frame.tick);
  }
  if (read.count() == ticks.count() && read.length() == ticks.length() && !reader->cut_short()) return {};
  return refuse(fmt::format("{}: {} of {} ticks can be read back", shown_path(options.output), read.count(), ticks.count()),
                "Write it to another disk.");
}

Outcome recover_trace(const RecoverOptions& options, TraceReader& reader) {
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input}));
  auto writer = TraceWriter::create(output.working_path(), reader.info());
  if (!writer) return refuse(options.output, writer.error());
  Report report{.command = "recover", .files = {{"trace", options.input}, {"recovered", options.output}}};
  report.timings = {{"read"}};
  TACTUS_TRY(const Rescue rescue, copy(reader, *writer, options, report));
  report_notes(reader.notes(), options.input, report);
  const std::vector<ReadLoss>& losses = reader.losses();
  if (report.ticks.count() == 0) {
    if (rescue.damage) return refuse(options.input, *rescue.damage);
    const std::string why = losses.empty() ? "" : "; " + loss_text(losses.front());
    return refuse(shown_path(options.input) + ": no whole tick is in it" + why, "Nothing can be recovered.");
  }
  if (const auto finished = writer->finish(); !finished) return refuse(options.output, finished.error());
  if (output.is_temporary()) TACTUS_CHECK(read_back(output.working_path(), options, report.ticks));
  TACTUS_CHECK(output.keep());
  report.describe(reader.info());
  add_losses(losses, report);
  if (rescue.damage)
    report.warnings.push_back(
        fmt::format("what comes after tick {} is damaged ({}) and lost", report.ticks.last(), rescue.damage->error.rule));
  else if (rescue.cut_short)
    report.warnings.push_back(
        fmt::format("the trace ends inside a chunk; what came after tick {} is lost, at most a second or 1 MiB "
                    "of messages if nothing else was cut off",
                    report.ticks.last()));
  else if (losses.empty()) report.warnings.emplace_back("nothing is missing: the trace is whole");
  print(report, options.common, beside(options.output));
  return {};
}

struct Copied {
  std::uint64_t messages = 0, attachments = 0, metadata = 0;
};

/// A recording of another program stays one: all topics, each message as it is.
tl::expected<Copied, Failure> copy_messages(mcap::Reader& reader, mcap::Writer& writer, const RecoverOptions& options) {
  constexpr std::size_t kChunk = 1u << 20;
  constexpr std::uint64_t kMessagesBetween = 1024;  // two looks at the bytes read
  Progress progress("recover", reader.files().bytes(), options.common.progress());
  Copied copied;
  std::map<std::uint16_t, bool> schemas, channels;  // written
  const auto failed = [&](const Error& error) { return refuse(options.output, error); };
  for (;;) {
    const auto item = reader.next();
    if (!item) return refuse(options.input, reader.explain(item.error()));
    if (*item == mcap::Item::end) break;
    if (*item == mcap::Item::message) {
      const mcap::Message& message = reader.message();
      if (!channels[message.channel_id]) {
        if (const auto ended = writer.end_chunk(); !ended) return failed(ended.error());
        const mcap::Channel& channel = reader.channels().at(message.channel_id);
        const auto schema = reader.schemas().find(channel.schema_id);
        if (schema != reader.schemas().end() && !std::exchange(schemas[channel.schema_id], true))
          if (const auto added = writer.add(schema->second); !added) return failed(added.error());
        if (const auto added = writer.add(channel); !added) return failed(added.error());
        channels[message.channel_id] = true;
      }
      writer.add(message);
      if (writer.chunk_size() >= kChunk)
        if (const auto ended = writer.end_chunk(); !ended) return failed(ended.error());
      if (copied.messages++ % kMessagesBetween == 0) progress.update(reader.bytes_read());
      continue;
    }
    if (const auto ended = writer.end_chunk(); !ended) return failed(ended.error());
    const bool is_metadata = *item == mcap::Item::metadata;
    const auto added = is_metadata ? writer.add(reader.metadata()) : writer.add(reader.attachment());
    if (!added) return failed(added.error());
    ++(is_metadata ? copied.metadata : copied.attachments);
  }
  return copied;
}

Outcome read_messages_back(const std::string& path, const RecoverOptions& options, std::uint64_t messages) {
  TACTUS_TRY(auto source,
             ByteSource::open_file(path).map_error([&](const Error& e) { return refuse(options.output, e).value(); }));
  auto reader = mcap::Reader::open(std::move(source));
  if (!reader) return refuse(options.output, reader.error());
  std::uint64_t read = 0;
  for (;;) {
    const auto item = reader->next();
    if (!item) return refuse(options.output, item.error());
    if (*item == mcap::Item::end) break;
    read += *item == mcap::Item::message ? 1U : 0U;
  }
  if (read == messages && !reader->cut_short()) return {};
  return refuse(fmt::format("{}: {} of {} messages can be read back", shown_path(options.output), read, messages),
                "Write it to another disk.");
}

Outcome recover_recording(const RecoverOptions& options, mcap::Reader& reader) {
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input}));
  auto writer = mcap::Writer::create(output.working_path(), "ros2");
  if (!writer) return refuse(options.output, writer.error());
  TACTUS_TRY(const Copied copied, copy_messages(reader, *writer, options));
  const std::vector<ReadLoss>& losses = reader.losses();
  if (copied.messages == 0) {
    const std::string why = losses.empty() ? "" : "; " + loss_text(losses.front());
    return refuse(shown_path(options.input) + ": no whole message is in it" + why, "Nothing can be recovered.");
  }
  if (const auto finished = writer->finish(); !finished) return refuse(options.output, finished.error());
  if (output.is_temporary()) TACTUS_CHECK(read_messages_back(output.working_path(), options, copied.messages));
  TACTUS_CHECK(output.keep());
  Report report{.command = "recover", .files = {{"recording", options.input}, {"recovered", options.output}}};
  report_notes(reader.notes().all(), options.input, report);
  report.warnings.push_back(fmt::format("{} of {} recovered, as another program wrote them", counted(copied.messages, "message"),
                                        counted(reader.channels().size(), "topic")));
  if (const auto announced = reader.files().announced_messages; announced && *announced != copied.messages)
    report.warnings.push_back(fmt::format("metadata.yaml lists {} messages", *announced));
  add_losses(losses, report);
  if (reader.cut_short())
    report.warnings.push_back("the recording ends without its index" +
                              (losses.empty() ? std::string("; what came after its last whole chunk is lost") : ""));
  else if (losses.empty()) report.warnings.emplace_back("nothing is missing: the recording is whole");
  print(report, options.common, beside(options.output));
  return {};
}

/// Whether the recording is a trace: its first metadata says so.
bool is_trace(mcap::Reader& reader) {
  for (;;) {
    const auto item = reader.next();
    if (!item || *item == mcap::Item::end || *item == mcap::Item::message) return false;
    if (*item == mcap::Item::metadata && reader.metadata().name == "tactus") return true;
  }
}

Outcome run_recover(const RecoverOptions& given) {
  RecoverOptions options = given;
  TACTUS_TRY(const auto input, RereadableInput::open(options.input));
  options.readable = input.path();
  auto files = files_of(options.readable, MissingFiles::leave_out);
  if (!files) return refuse(options.input, files.error());
  auto first = mcap::Reader::open(*files, OnDamage::skip);
  if (!first) return refuse(options.input, first.error());
  if (is_trace(*first)) {
    auto reader = open_trace(options.readable, options.input, options.common.progress(), {.on_damage = OnDamage::skip});
    if (!reader) return tl::unexpected(reader.error());
    return recover_trace(options, *reader);
  }
  auto recording = mcap::Reader::open(*std::move(files), OnDamage::skip);
  if (!recording) return refuse(options.input, recording.error());
  return recover_recording(options, *recording);
}

}  // namespace

void setup_recover(Command& app, Action& action) {
  auto options = std::make_shared<RecoverOptions>();
  Command& command = app.add_command("recover", "Save what can be read of a trace that was cut or damaged");
  command
      .add_option("TRACE", options->input, "Trace or recording that was not finished, or is damaged (MCAP, or a bag's folder)")
      ->type_name("")
      ->required();
  command.add_option("-o,--output", options->output, "Trace to write (MCAP)")->required()->type_name("FILE");
  add_output_options(command, options->common);
  command.footer(
      "Writes all that can be read, with an index, reads it back and says what is lost. Of a trace that is ticks; of a\n"
      "recording of another program all messages of all topics, as they are.\n"
      "Example:\n  tactus recover crashed.mcap -o rescued.mcap");
  on_chosen<RecoverOptions>(command, action, options, run_recover);
}

}  // namespace tactus::cli
