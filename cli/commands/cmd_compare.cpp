// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <filesystem>

#include <tactus/base/shown.h>
#include <tactus/trace/trace_file.h>
#include <tactus/trace/trace_scene.h>
#include "cli/commands/input.h"
#include "cli/commands/replica_errors.h"
#include "cli/figure/time_figure.h"
#include "cli/options/contact_option.h"
#include "cli/report/report.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

struct CompareOptions {
  std::string truth, replica, plot;
  TriggerArguments triggers;
  MeshArguments meshes;
  ContactArguments contacts;
  CommonOptions common;
};

/// What is compared goes to the figure, too.
void judge_tick(const TraceFrame& truth, const ShownByReplica& shown, Report& report, std::optional<ErrorFigure>& figure) {
  add_errors(truth, shown, report);
  if (!figure) return;
  figure->add(truth, shown.poses);
  for (std::size_t i = 0; i < shown.shapes.size(); ++i)
    if (truth.meshes[i].updated) figure->add_shape(truth, i, shown.shapes[i]);
}

/// One of the two traces, at its next frame.
struct Side {
  const std::string& path;
  TraceReader reader;
  TraceFrame frame{};
  bool more = false;  // the frame is one
  std::uint64_t frames = 0;
  std::uint64_t unmatched = 0;  // of them, whose tick the other trace lacks

  Outcome advance() {
    TACTUS_TRY(const bool next, next_frame(reader, frame, path));
    more = next;
    frames += more ? 1 : 0;
    return more ? Outcome() : check_ending(path, reader, frames);
  }
  /// The tick whose objects the frame has.
  std::int64_t time() const { return reader.info().shows_past ? frame.shown : frame.tick; }
  bool is_before(const Side& other) const { return more && (!other.more || time() < other.time()); }
};

/// Both traces side by side; ticks that only one of them has are counted and passed over. A client that shows a tick for longer is held
/// against it each time.
Outcome compare_all(Side& truth, Side& replica, const ContactDeclarations& contacts, const CompareOptions& options,
                    Report& report, std::optional<ErrorFigure>& figure) {
  ReadProgress progress("compare", &truth.reader, options.common.progress());
  ShownByReplica shown(truth.reader.info());
  TACTUS_CHECK(truth.advance());
  TACTUS_CHECK(replica.advance());
  while (truth.more || replica.more) {
    const bool has_truth = !replica.is_before(truth), has_replica = !truth.is_before(replica);
    if (has_replica) shown.take(replica.frame);
    if (has_truth && has_replica) {
      contacts.apply(truth.frame);
      report.timings[0].times.measure([&] { return judge_tick(truth.frame, shown, report, figure), true; });
      report.ticks.add(replica.frame.tick);
      progress.update(report.ticks.count());
    } else {
      ++(has_truth ? truth : replica).unmatched;
    }
    if (has_replica) TACTUS_CHECK(replica.advance());
    if (has_truth && !(replica.more && replica.time() == truth.time())) TACTUS_CHECK(truth.advance());
  }
  return {};
}

/// Says which ticks were left out.
void note_unmatched(const Side& truth, const Side& replica, Report& report) {
  std::string text;
  if (truth.unmatched > 0) text = fmt::format("{} of {} ticks are not in the replica", truth.unmatched, truth.frames);
  if (replica.unmatched > 0) {
    text += fmt::format("{}{} of the replica's {} ticks are not in the truth", text.empty() ? "" : " and ", replica.unmatched,
                        replica.frames);
  }
  if (text.empty()) return;
  const bool is_live = replica.reader.info().shows_past;
  report.warnings.push_back(text + ". They were left out" + (is_live ? "" : "; decode with --like " + truth.path));
}

tl::expected<Side, Failure> open(const std::string& path, const CompareOptions& options) {
  auto reader = open_trace(path, options.common.progress());
  if (!reader) return tl::unexpected(reader.error());
  return Side{path, std::move(*reader)};
}

Outcome run_compare(const CompareOptions& options) {
  TACTUS_CHECK(check_plot_option(options.plot, options.common, {options.truth, options.replica}));
  TACTUS_TRY(auto truth, open(options.truth, options));
  TACTUS_TRY(auto replica, open(options.replica, options));
  const TraceInfo& info = truth.reader.info();
  TACTUS_CHECK(check_same_scene(options.truth, info, options.replica, replica.reader.info()));

  TACTUS_TRY(const ContactDeclarations contacts, options.contacts.of(info, options.truth));
  note_idle_options(*options.common.command, subjects_of(info), "truth");

  Report report{.command = "compare", .files = {{"truth", options.truth}, {"replica", options.replica}}};
  report.describe(info);
  const TypedBounds typed{options.triggers, options.meshes};
  judge_by(&typed, info, replica.reader.info().bounds, report);
  report.timings = {{"compare"}};
  std::optional<ErrorFigure> figure;
  if (!options.plot.empty()) figure.emplace(info);
  TACTUS_CHECK(compare_all(truth, replica, contacts, options, report, figure));
  if (report.ticks.count() == 0)
    return refuse(shown_path(options.replica) + ": shares no tick with " + shown_path(options.truth),
                  "Decode with --like " + shown_path(options.truth) + ".");
  note_unmatched(truth, replica, report);
  for (const Side* side : {&truth, &replica}) report.add(side->reader.notes());
  if (figure)
    TACTUS_CHECK(draw(options.plot,
                      Figure{"Error of " + std::filesystem::path(options.replica).filename().string(), figure->panels(report)},
                      options.common));
  note_idle_deadband(*options.common.command, report);
  print(report, options.common, Destination::standard_output);
  return report.bounds_from == "defaults" ? Outcome() : verdict(report, options.replica);  // nobody asked for those
}

}  // namespace

void setup_compare(Command& app, Action& action) {
  auto options = std::make_shared<CompareOptions>();
  Command& command = app.add_command("compare", "Measure the error of a replica");
  command.add_option("TRUTH", options->truth, "Trace of the server (MCAP)")->type_name("")->required();
  command.add_option("REPLICA", options->replica, "Trace of the client, from `tactus decode` or `tactus join` (MCAP)")
      ->type_name("")
      ->required();
  options->triggers.add_to(command);
  options->meshes.add_to(command);
  options->contacts.add_to(command);
  add_plot_option(command, options->plot, "the errors beside their bounds, over time");
  add_output_options(command, options->common);
  command.footer(
      "The bounds are those that the stream of the replica declares; options override them. Exit status 3: a bound is broken.\n"
      "Ticks that only one of the traces has are left out; a warning gives their number. What a client of `tactus join` shows is "
      "held\n"
      "against the tick that it is of.\n"
      "Examples:\n"
      "  tactus compare push.mcap replica.mcap -p 8% --visual 6mm,2deg --plot errors.svg\n"
      "  tactus compare server.mcap client.mcap -p 4%");
  on_chosen<CompareOptions>(command, action, options, run_compare);
}

}  // namespace tactus::cli
