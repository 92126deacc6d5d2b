// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <new>
#include <string_view>

#include "cli/commands/commands.h"
#include "cli/options/headings.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/report/report.h"
#include "cli/version.h"

namespace tactus::cli {
namespace {

/// A command, "import_mesh" one of the group "import".
struct Entry {
  std::string_view name;
  void (*setup)(Command& group, Action& action);  ///< nullptr: not built, or a script
  const char* needs;                              ///< the option of CMake that brings it then
};
constexpr Entry kCommands[] = {
#include "commands.inc"
};

constexpr int kOk = 0, kFailed = 1, kUsage = 2, kBroken = 3, kSignal = 128;

int status_of(const Failure& failure) {
  using Cause = Failure::Cause;
  switch (failure.cause) {
    case Cause::work:
      return kFailed;
    case Cause::arguments:
      return kUsage;
    case Cause::bound:
      return kBroken;
    case Cause::stopped:
      return kSignal + failure.signal;
  }
  return kFailed;
}

int report_failure(const Failure& failure, bool as_json) {
  const bool coloured = is_coloured(2);
  if (as_json) {
    std::fflush(stdout);
    fmt::print(stderr, "{}\n", error_json(failure));
    return status_of(failure);
  }
  const char* label = failure.cause == Failure::Cause::bound     ? "broken:"
                      : failure.cause == Failure::Cause::stopped ? ""
                                                                 : "error:";
  std::fflush(stdout);  // what was printed comes first where both streams end in one place
  const bool marked = coloured && *label != '\0';
  fmt::print(stderr, "{}{}{}{}{}\n", marked ? "\x1b[1;31m" : "", label, marked ? "\x1b[0m" : "", *label ? " " : "",
             printable(failure.text));
  if (!failure.remedy.empty()) fmt::print(stderr, "       {}\n", printable(failure.remedy));
  return status_of(failure);
}

/// Exceptions are for what nobody foresaw: what an input can cause is an error of its own where it is found.
Outcome run(const Action& action) {
  try {
    return action();
  } catch (const std::bad_alloc&) {
    return refuse("there is not enough memory", "Give smaller inputs, or run it on a larger machine.");
  } catch (const std::exception& e) {
    return refuse(std::string("the program has a defect: ") + e.what(), "Report it with the command and its inputs.");
  }
}

void add(Command& app, const Entry& entry, Action& action) {
  const std::size_t split = entry.name.find('_');
  const bool is_own = split == std::string_view::npos;
  Command& group = is_own ? app : app.command(entry.name.substr(0, split));
  if (is_script(entry.name)) {
    setup_script(app, entry.name, action);
    app.command(entry.name).heading(heading_of_command(entry.name));
    return;
  }
  if (entry.setup == nullptr) {
    group.leave_out(std::string(entry.name.substr(split + 1)), entry.needs, action);
    return;
  }
  entry.setup(group, action);
  if (is_own) app.command(entry.name).heading(heading_of_command(entry.name));
}

int finish(Outcome outcome, bool as_json) {
  if (outcome) outcome = check_standard_output();
  return outcome ? kOk : report_failure(outcome.error(), as_json);
}

}  // namespace
}  // namespace tactus::cli

int main(int argc, char** argv) {
  using namespace tactus::cli;
  if (argc > 1 && is_script(argv[1])) {
    const bool wants_json = std::any_of(argv, argv + argc, [](std::string_view word) { return word == "--json"; });
    return finish(run_script(argv[1], {argv + 2, argv + argc}), wants_json);
  }
  Program app("tactus", "Codec for shared haptic virtual environments: which object states to send, and in how few bits");
  app.footer(
      "First steps:\n"
      "  tactus sim push-1dof -o push.mcap                        simulate a touch and record it\n"
      "  tactus encode push.mcap -o push.tct -p 4%                encode it into packets\n"
      "  tactus decode push.tct -o replica.mcap --like push.mcap  decode what a client shows\n"
      "  tactus compare push.mcap replica.mcap -p 4%              measure the error\n"
      "`tactus help COMMAND` lists all options. Quantities take units: 2deg, 5mm, 4%, 100ms, 0.05N.\n"
      "Exit status: 0 done, 1 an input was refused or the work failed, 2 the arguments are wrong,\n"
      "3 done, but a bound that the stream declares or an option sets is broken, or contacts of the simulation were not solved,\n"
      "128 + n stopped by signal n, such as 130 by Ctrl-C.");
  Action action;
  bool wants_version = false, as_json = false;
  app.add_flag("--version", wants_version, "Print version, commit, compiler and components");
  app.add_flag("--json", as_json, "Print the version as JSON");
  for (const Entry& entry : kCommands) add(app, entry, action);
  const auto parsed = app.parse(argc, argv);
  if (!parsed) return report_failure(parsed.error(), app.wants_json());
  if (*parsed == Program::Parsed::done) return finish({}, false);
  if (wants_version) {
    print_version(as_json);
    return finish({}, false);
  }
  if (!action) {
    fmt::print(stderr, "{}", app.help_of_typed());
    return kUsage;
  }
  return finish(run(action), app.wants_json());
}
