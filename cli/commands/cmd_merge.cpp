// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include <tactus/base/shown.h>
#include <tactus/trace/trace_file.h>
#include "cli/report/report.h"
#include "cli/report/trace_ending.h"

namespace tactus::cli {
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
    const auto next = reader.next(frame);
    if (!next) return refuse(path, next.error());
    more = *next;
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
  Progress progress("merge", parts[0].reader.frame_count(), options.common.progress());
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
    if (!written) return refuse(options.output, place_of_tick(tick), written.error());
    report.ticks.add(tick);
    progress.update(parts[0].frames);
    for (Part& part : parts) TACTUS_CHECK(part.advance());
  }
  for (Part& part : parts)
    for (; part.more; ++part.unmatched) TACTUS_CHECK(part.advance());
  return {};
}

Outcome run(const MergeOptions& options) {
  TACTUS_CHECK(check_no_terminal(options.output));
  if (options.inputs.size() < 2) return refuse_arguments("TRACES: one trace alone is merged already", "Give two or more.");
  std::vector<Part> parts;
  TraceInfo all;
  Report report{.command = "merge", .files = {{"merged", options.output}}};
  for (const std::string& path : options.inputs) {
    auto reader = open_trace(path);
    if (!reader) return tl::unexpected(reader.error());
    parts.push_back({path, std::move(*reader), static_cast<std::uint32_t>(all.objects.size()),
                     static_cast<std::uint32_t>(all.meshes.size())});
    TACTUS_CHECK(append(parts.back(), all, report.warnings));
  }
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), options.inputs));
  auto writer = TraceWriter::create(output.working_path(), all);
  if (!writer) return refuse(options.output, writer.error());
  report.timings = {{"write", "write, per tick"}};
  TACTUS_CHECK(merge(parts, *writer, options, report));
  if (report.ticks.count() == 0) return refuse("there is no tick that all traces have", "`tactus cut --rebase` moves one.");
  if (const auto finished = writer->finish(); !finished) return refuse(options.output, finished.error());
  TACTUS_CHECK(output.keep());
  report.describe(all);
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
      "Names that occur twice get numbers, ticks that are not in all traces are left out; warnings tell. Scenes and bounds\n"
      "are not carried over.\n"
      "Example:\n  tactus merge objects.mcap hand.mcap -o all.mcap");
  on_chosen<MergeOptions>(command, action, options, run);
}

}  // namespace tactus::cli
