// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include <tactus/base/shown.h>
#include <tactus/trace/resampler.h>
#include <tactus/trace/trace_file.h>
#include "cli/commands/commands.h"
#include "cli/commands/input.h"
#include "cli/options/units.h"
#include "cli/report/notes.h"
#include "cli/report/report.h"

namespace tactus::cli {

// ==== cmd cut ====

namespace {

struct CutOptions {
  std::string input, output;
  double from = 0, to = std::numeric_limits<double>::infinity();  // [s]
  bool rebase = false;
  CommonOptions common;
};

/// The first tick at or after a time.
std::int64_t tick_at(double seconds, std::uint32_t rate) {
  const double tick = std::ceil(seconds * rate - 1e-6);
  return tick < 0x1p62 ? static_cast<std::int64_t>(tick) : std::int64_t{1} << 62;
}

/// A shape that was new before the cut is new at its first frame.
void begin_shapes(TraceFrame& frame) {
  for (DeformableSample& mesh : frame.meshes)
    for (const float u : mesh.displacements) mesh.updated = mesh.updated || u != 0;
}

Outcome copy(TraceReader& reader, TraceWriter& writer, const CutOptions& options, Report& report) {
  const std::uint32_t rate = reader.info().tick_rate;
  const std::int64_t from = tick_at(options.from, rate), to = tick_at(options.to, rate);
  ReadProgress progress("cut", &reader, options.common.progress());
  TraceFrame frame;
  std::optional<std::int64_t> base;
  for (std::uint64_t read = 1;; ++read) {
    TACTUS_TRY(const bool more, report.timings[0].times.measure([&] { return next_frame(reader, frame, options.input); }));
    if (!more) return check_ending(options.input, reader, read - 1);
    progress.update(read);
    if (frame.tick < from) continue;
    if (frame.tick >= to) return print_notes(reader.notes(), options.input), Outcome();
    if (!base) {
      base = options.rebase ? frame.tick : 0;
      begin_shapes(frame);
    }
    frame.tick -= *base;
    if (const auto written = writer.write(frame); !written)
      return refuse(options.output, location_of_tick(frame.tick), written.error());
    report.ticks.add(frame.tick);
  }
}

Outcome run_cut(const CutOptions& options) {
  TACTUS_CHECK(check_no_terminal(options.output));
  if (options.to <= options.from) return refuse_arguments("--to: nothing lies between it and --from", "Give a later --to.");
  auto reader = open_trace(options.input, options.common.progress());
  if (!reader) return tl::unexpected(reader.error());
  const TraceInfo& info = reader->info();
  if (options.rebase && info.shows_past)
    return refuse(shown_path(options.input) + ": a client's trace, whose ticks are those of the server", "Leave out --rebase.");
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input}));
  auto writer = TraceWriter::create(output.working_path(), info);
  if (!writer) return refuse(options.output, writer.error());
  Report report{.command = "cut", .files = {{"trace", options.input}, {"cut", options.output}}};
  report.timings = {{"read"}};
  TACTUS_CHECK(copy(*reader, *writer, options, report));
  if (report.ticks.count() == 0)
    return refuse(shown_path(options.input) + ": no tick lies between --from and --to",
                  "`tactus info` shows its first and last.");
  if (const auto finished = writer->finish(); !finished) return refuse(options.output, finished.error());
  TACTUS_CHECK(output.keep());
  report.describe(info);
  report.add(reader->notes());
  print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_cut(Command& app, Action& action) {
  auto options = std::make_shared<CutOptions>();
  Command& command = app.add_command("cut", "Take a piece out of a trace");
  command.add_option("TRACE", options->input, "Trace to cut (MCAP), - is standard input")->type_name("")->required();
  command.add_option("-o,--output", options->output, "Trace to write (MCAP), - is standard output")
      ->required()
      ->type_name("FILE");
  add_quantity(command, "--from", options->from, Dimension::time, "Leave out what is before this time [the first tick]");
  add_quantity(command, "--to", options->to, Dimension::time, "Leave out this time and what is after it [the last tick]");
  command.add_flag("--rebase", options->rebase, "Let the first tick be tick 0");
  add_output_options(command, options->common);
  command.footer(
      "Times are those of the trace; they stay what they are unless --rebase is given.\n"
      "Example:\n  tactus cut push.mcap --from 2s --to 3.5s -o contact.mcap");
  on_chosen<CutOptions>(command, action, options, run_cut);
}

// ==== cmd merge ====

namespace {

struct MergeOptions {
  std::vector<std::string> inputs;
  std::string output;
  CommonOptions common;
};

/// A trace to merge, at its next frame. Its objects and meshes come behind those of the traces before.
struct Part {
  const std::string& path;
  TraceReader reader;
  std::uint32_t first_object, first_mesh;
  TraceFrame frame{};
  std::vector<bool> is_new{};               // shapes since the last merged frame
  std::uint64_t frames = 0, unmatched = 0;  // read; without one in each of the others
  bool more = false;

  Outcome advance() {
    TACTUS_TRY(const bool next, next_frame(reader, frame, path));
    more = next;
    frames += more ? 1 : 0;
    is_new.resize(frame.meshes.size());
    for (std::size_t i = 0; i < is_new.size(); ++i) is_new[i] = is_new[i] || (more && frame.meshes[i].updated);
    return more ? Outcome() : check_ending(path, reader, frames);
  }
};

/// Take over what has a name; one that is there already gets a number: "hand 2".
template <class Named>
void append_named(const std::string& what, const std::vector<Named>& from, const std::string& path, std::vector<Named>& all,
                  std::vector<std::string>& notes) {
  for (Named item : from) {
    const std::string name = item.name;
    for (int number = 2; std::ranges::find(all, item.name, &Named::name) != all.end(); ++number)
      item.name = fmt::format("{} {}", name, number);
    if (item.name != name) notes.push_back(fmt::format("{} \"{}\" of {} is called \"{}\"", what, name, path, item.name));
    all.push_back(std::move(item));
  }
}

Outcome append(const Part& part, TraceInfo& all, std::vector<std::string>& notes) {
  const TraceInfo& info = part.reader.info();
  if (info.shows_past)
    return refuse(shown_path(part.path) + ": a client's trace; what it shows is of other ticks", "Merge recordings of one time.");
  if (!all.source.empty() && info.tick_rate != all.tick_rate)
    return refuse(fmt::format("{}: {} ticks per second, not {}", shown_path(part.path), info.tick_rate, all.tick_rate),
                  fmt::format("`tactus resample --rate {}` makes them alike.", all.tick_rate));
  all.tick_rate = info.tick_rate;
  all.source += (all.source.empty() ? "merge " : ", ") + part.path;
  append_named("object", info.objects, part.path, all.objects, notes);
  append_named("user", info.users, part.path, all.users, notes);
  append_named("mesh", info.meshes, part.path, all.meshes, notes);
  return {};
}

void append(Part& part, TraceFrame& all) {
  const TraceFrame& frame = part.frame;
  all.objects.insert(all.objects.end(), frame.objects.begin(), frame.objects.end());
  for (std::size_t i = 0; i < frame.meshes.size(); ++i) {
    all.meshes.push_back({part.is_new[i], frame.meshes[i].displacements});
    part.is_new[i] = false;
  }
  for (UserSample user : frame.users) {
    user.contact.object += part.first_object;
    if (user.surface_contact) user.surface_contact->mesh += part.first_mesh;
    all.users.push_back(user);
  }
}

/// The ticks that all traces have.
Outcome merge(std::vector<Part>& parts, TraceWriter& writer, const MergeOptions& options, Report& report) {
  ReadProgress progress("merge", &parts[0].reader, options.common.progress());
  for (Part& part : parts) TACTUS_CHECK(part.advance());
  while (std::ranges::all_of(parts, &Part::more)) {
    const std::int64_t tick = std::ranges::max_element(parts, {}, [](const Part& p) { return p.frame.tick; })->frame.tick;
    bool is_everywhere = true;
    for (Part& part : parts) {
      if (part.frame.tick == tick) continue;
      is_everywhere = false;
      ++part.unmatched;
      TACTUS_CHECK(part.advance());
    }
    if (!is_everywhere) continue;
    TraceFrame all{.tick = tick, .objects = {}, .users = {}};
    for (Part& part : parts) append(part, all);
    const auto written = report.timings[0].times.measure([&] { return writer.write(all); });
    if (!written) return refuse(options.output, location_of_tick(tick), written.error());
    report.ticks.add(tick);
    progress.update(parts[0].frames);
    for (Part& part : parts) TACTUS_CHECK(part.advance());
  }
  for (Part& part : parts)
    for (; part.more; ++part.unmatched) TACTUS_CHECK(part.advance());
  return {};
}

Outcome run_merge(const MergeOptions& options) {
  TACTUS_CHECK(check_no_terminal(options.output));
  if (options.inputs.size() < 2) return refuse_arguments("TRACES: one trace alone is merged already", "Give two or more.");
  std::vector<Part> parts;
  TraceInfo all;
  Report report{.command = "merge", .files = {{"merged", options.output}}};
  for (const std::string& path : options.inputs) {
    auto reader = open_trace(path, options.common.progress());
    if (!reader) return tl::unexpected(reader.error());
    parts.push_back({path, std::move(*reader), static_cast<std::uint32_t>(all.objects.size()),
                     static_cast<std::uint32_t>(all.meshes.size())});
    TACTUS_CHECK(append(parts.back(), all, report.warnings));
  }
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), options.inputs));
  auto writer = TraceWriter::create(output.working_path(), all);
  if (!writer) return refuse(options.output, writer.error());
  report.timings = {{"write"}};
  TACTUS_CHECK(merge(parts, *writer, options, report));
  if (report.ticks.count() == 0) return refuse("there is no tick that all traces have", "`tactus cut --rebase` moves one.");
  if (const auto finished = writer->finish(); !finished) return refuse(options.output, finished.error());
  TACTUS_CHECK(output.keep());
  report.describe(all);
  for (const Part& part : parts) report.add(part.reader.notes());
  for (const Part& part : parts)
    if (part.unmatched > 0)
      report.warnings.push_back(
          fmt::format("{} of {} ticks of {} are not in all traces; they were left out", part.unmatched, part.frames, part.path));
  print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_merge(Command& app, Action& action) {
  auto options = std::make_shared<MergeOptions>();
  Command& command = app.add_command("merge", "Put the objects and users of several traces into one");
  command.add_option("TRACES", options->inputs, "Traces with the same ticks (MCAP)")->type_name("")->required();
  command.add_option("-o,--output", options->output, "Trace to write (MCAP), - is standard output")
      ->required()
      ->type_name("FILE");
  add_output_options(command, options->common);
  command.footer(
      "Names that occur twice get numbers, ticks that are not in all traces are left out; warnings say so. Scenes and bounds\n"
      "are not carried over.\n"
      "Example:\n  tactus merge objects.mcap hand.mcap -o all.mcap");
  on_chosen<MergeOptions>(command, action, options, run_merge);
}

// ==== cmd resample ====

namespace {

struct ResampleOptions {
  std::string input, output;
  std::uint32_t rate = 1000;
  double gap = 0.1;  // [s]
  CommonOptions common;
};

Outcome write_due(Resampler& resampler, TraceFrame& frame, TraceWriter& writer, const ResampleOptions& options, Report& report) {
  while (resampler.next(frame)) {
    if (const auto written = writer.write(frame); !written)
      return refuse(options.output, location_of_tick(frame.tick), written.error());
    report.ticks.add(frame.tick);
  }
  return {};
}

Outcome resample(TraceReader& reader, Resampler& resampler, TraceWriter& writer, const ResampleOptions& options, Report& report) {
  ReadProgress progress("resample", &reader, options.common.progress());
  TraceFrame in, out;
  for (std::uint64_t read = 0;; ++read) {
    TACTUS_TRY(const bool more, next_frame(reader, in, options.input));
    if (!more) {
      resampler.end();
      TACTUS_CHECK(write_due(resampler, out, writer, options, report));
      return check_ending(options.input, reader, read);
    }
    const auto worked = report.timings[0].times.measure([&] {
      resampler.add(in);
      return write_due(resampler, out, writer, options, report);
    });
    TACTUS_CHECK(worked);
    progress.update(read + 1);
  }
}

Outcome run_resample(const ResampleOptions& options) {
  TACTUS_CHECK(check_no_terminal(options.output));
  auto reader = open_trace(options.input, options.common.progress());
  if (!reader) return tl::unexpected(reader.error());
  if (reader->info().shows_past)
    return refuse(shown_path(options.input) + ": a client's trace, whose ticks are those of the server",
                  "Resample the recordings that it was made from.");
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input}));
  Resampler resampler(reader->info(), options.rate, options.gap);
  auto writer = TraceWriter::create(output.working_path(), resampler.info());
  if (!writer) return refuse(options.output, writer.error());
  Report report{.command = "resample", .files = {{"trace", options.input}, {"resampled", options.output}}};
  report.timings = {{"resample"}};
  TACTUS_CHECK(resample(*reader, resampler, *writer, options, report));
  if (report.ticks.count() == 0)
    return refuse(shown_path(options.input) + ": too short for a tick at this rate", "Give a higher --rate.");
  if (const auto finished = writer->finish(); !finished) return refuse(options.output, finished.error());
  TACTUS_CHECK(output.keep());
  report.describe(resampler.info());
  report.add(reader->notes());
  print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_resample(Command& app, Action& action) {
  auto options = std::make_shared<ResampleOptions>();
  Command& command = app.add_command("resample", "Write a trace at another rate");
  command.add_option("TRACE", options->input, "Trace to resample (MCAP), - is standard input")->type_name("")->required();
  command.add_option("-o,--output", options->output, "Trace to write (MCAP), - is standard output")
      ->required()
      ->type_name("FILE");
  command.add_option("--rate", options->rate, "Ticks per second")
      ->check(whole_number(1, 1'000'000))
      ->show_default()
      ->type_name("HZ");
  add_quantity(command, "--gap", options->gap, Dimension::time, "A pause longer than this stays one [100ms]");
  add_output_options(command, options->common);
  command.footer(
      "Positions, velocities and forces follow straight lines between samples, rotations arcs; contacts, buttons and shapes\n"
      "are those of the sample before. Nothing is filtered.\n"
      "Example:\n  tactus resample handwriting.mcap --rate 1000 -o at-1kHz.mcap");
  on_chosen<ResampleOptions>(command, action, options, run_resample);
}

}  // namespace tactus::cli
