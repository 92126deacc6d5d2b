// SPDX-License-Identifier: Apache-2.0
/// All figures of the thesis in one report. Each is made by this program in a process of its own, as its command would make it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>

#include "cli/figure/child_process.h"
#include "cli/laboratory/cmd_reproduce.h"
#include "cli/output.h"
#include "cli/progress.h"

namespace tactus::cli {
namespace {

/// What the reader is told beside the numbers.
struct Chapter {
  const char* figure;
  const char* title;
  const char* remark;
};

constexpr std::array kChapters{
    Chapter{"fig3.3", "why updates are sent while a cube is pushed", ""},
    Chapter{"fig3.6", "object states or forces", ""},
    Chapter{"fig3.8", "ways of interpolation", "The figure shows preferences, which need people: they liked linear best."},
    Chapter{"fig3.10", "updates at the deadbands that the subjects chose",
            "The deadbands are those of the thesis's subjects; the rates are ours."},
    Chapter{"fig3.11", "the force with and without interpolation", ""},
    Chapter{"fig3.14", "the traffic settings of table 3.3",
            "The thesis's people are replaced by virtual hands: the scene's, which is slower and steadier, and a faster one. The "
            "ratings need people."},
    Chapter{"fig4.1", "two users push a block: what delay does", ""},
    Chapter{"fig4.2", "a user presses a membrane: what delay does", ""},
    Chapter{"fig4.6", "a push at constant speed", ""},
    Chapter{"fig4.7", "impedance of a rigid object at a client", ""},
    Chapter{"fig4.8", "a cube is pushed forth and back",
            "The figure shows ratings, which need people. This is their task; in their place, the share of the time outside of "
            "the area of "
            "perceived transparency, +-10 %."},
    Chapter{"fig4.10", "two users push a block side by side", ""},
    Chapter{"fig4.11", "one user pushes a block, another presses on it", ""},
    Chapter{"fig4.12", "one user pushes a block, another stops it", ""},
    Chapter{"fig4.13a", "the delay that varies", "Tables 4.1 and 4.2 and figure 4.26 are what people said of it."},
    Chapter{"fig4.16", "the critical stiffness at the server", ""},
    Chapter{"fig4.17", "grip, damping and object stiffness at a client", ""},
    Chapter{"fig4.18", "two users at one object: what delay does", ""},
    Chapter{"fig4.20", "impedance of a deformable object at a client", ""},
    Chapter{"fig4.21", "one press", ""},
    Chapter{"fig4.22", "the same impedance with compensation", ""},
    Chapter{"fig4.23", "the stiffness of the membrane", ""},
    Chapter{"fig4.24", "two users at one object, with compensation", ""},
    Chapter{"fig4.25", "two hands at a one-dimensional object", ""},
    Chapter{"fig4.27", "a hand on the membrane", ""},
};

/// Shown on the membrane, which needs finite elements.
bool can_make([[maybe_unused]] std::string_view figure) {
#ifdef TACTUS_HAS_FEM
  return true;
#else
  return figure != "fig4.2" && figure != "fig4.23" && figure != "fig4.27";
#endif
}

/// Options that are not as usual, as they are typed.
std::vector<std::string> settings_of(const ReproduceOptions& options) {
  const ReproduceOptions usual;
  std::vector<std::string> out;
  if (options.seeds != usual.seeds) out.insert(out.end(), {"--seeds", std::to_string(options.seeds)});
  if (options.grip != usual.grip) out.insert(out.end(), {"--grip", options.grip});
  if (options.pace != usual.pace) out.insert(out.end(), {"--pace", fmt::format("{}", options.pace)});
  if (options.tremor != usual.tremor) out.insert(out.end(), {"--tremor", fmt::format("{}m", options.tremor)});
  if (options.length_unit != usual.length_unit) out.insert(out.end(), {"--length-unit", fmt::format("{}m", options.length_unit)});
  return out;
}
std::string typed(const char* figure, const ReproduceOptions& options) {
  std::string out = fmt::format("tactus reproduce {}", figure);
  for (const std::string& setting : settings_of(options)) out += " " + setting;
  return out;
}

std::string heading(const ReproduceOptions& options) {
  return fmt::format(
      "# The thesis, figure by figure\n\n"
      "Made by `{} -o DIR`, each section by the command in it: what comes out here beside the numbers of the "
      "thesis, where it gives any. Everything is deterministic. Differences are told where they are: "
      "[rates](../../README.md), [delay](../delay/README.md).\n\n"
      "Reproduced elsewhere: figure 2.2 and eqs. 4.37 and 4.38 ([stability](../stability/report.md)), figures 3.18 and 3.20 "
      "([deformable objects](../deformable/README.md)). What needs people is not reproduced: the ratings of chapter 3 and of "
      "figures "
      "4.8 and 4.26, and tables 4.1 and 4.2.\n",
      typed("all", options));
}

tl::expected<std::string, Failure> section(const Chapter& chapter, const ReproduceOptions& options) {
  std::vector<std::string> command{own_program(), "reproduce", chapter.figure, "-q"};
  std::ranges::copy(settings_of(options), std::back_inserter(command));
  if (is_drawn(chapter.figure)) command.insert(command.end(), {"-o", options.directory});
  if (options.common.existing() == OutputFile::Existing::replace) command.emplace_back("-f");
  const auto done = run_child(command);
  if (!done) return refuse_arguments(fmt::format("{}: {}", chapter.figure, done.error().message()), "Run the command again.");
  if (done->status != 0)
    return refuse_arguments(fmt::format("{}: {}", chapter.figure, done->error), "Run this figure alone to see more.");
  std::string out =
      fmt::format("\n## Figure {}: {}\n\n`{}`\n", chapter.figure + 3, chapter.title, typed(chapter.figure, options));
  if (*chapter.remark != '\0') out += fmt::format("\n{}\n", chapter.remark);
  out += fmt::format("\n```\n{}```\n", done->out);
  const std::string picture = std::string(chapter.figure) + ".svg";
  if (std::filesystem::exists(options.directory + "/" + picture)) out += fmt::format("\n![{}]({})\n", chapter.title, picture);
  return out;
}

}  // namespace

Outcome reproduce_all(const ReproduceOptions& options) {
  if (options.directory.empty()) return refuse_arguments("all: --output is missing", "Give a folder for the report: -o thesis.");
  if (options.common.json) return refuse_arguments("all: no --json", "Ask each figure for its JSON.");
  TACTUS_CHECK(make_folder(options.directory));
  const std::string report = options.directory + "/report.md";
  TACTUS_CHECK(OutputFile::check_free(report, options.common.existing()));
  std::string text = heading(options);
  Progress progress("reproduce all", kChapters.size(), options.common.progress());
  for (std::size_t i = 0; i < kChapters.size(); ++i) {
    if (can_make(kChapters[i].figure)) {
      TACTUS_TRY(const std::string made, section(kChapters[i], options));
      text += made;
    } else {
      fmt::print(stderr, "note: {}: left out, as this program was built without finite elements\n", kChapters[i].figure);
    }
    progress.update(i + 1);
  }
  TACTUS_CHECK(write_file(report, text, options.common.existing()));
  if (!options.common.quiet)
    fmt::print("{}: {} figures\n", report, std::ranges::count_if(kChapters, [](const Chapter& c) { return can_make(c.figure); }));
  return {};
}

}  // namespace tactus::cli
