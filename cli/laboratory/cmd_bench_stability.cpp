// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "cli/laboratory/cmd_bench.h"
#include "cli/laboratory/stability_plots.h"
#include "cli/laboratory/study_report.h"
#include "cli/options/options_codec.h"
#include "lab/study/stability.h"
#ifdef TACTUS_HAS_FEM
#include "lab/study/stability_fem.h"
#endif

namespace tactus::cli {
namespace {

using sim::study::Study;

struct StabilityOptions {
  std::vector<std::string> cases;
  bool brief = false;
  std::string directory;
  CommonOptions common;
};

struct Case {
  const char* name;
  Study (*run)(sim::study::Extent, const sim::study::Progress&);
};
constexpr Case kCases[] = {{"jury", sim::study::study_jury},
                           {"wall", sim::study::study_wall},
                           {"client", sim::study::study_client},
                           {"rigid", sim::study::study_rigid},
#ifdef TACTUS_HAS_FEM
                           {"fem", sim::study::study_fem}
#endif
};

std::vector<std::string> case_names() {
  std::vector<std::string> out;
  for (const Case& one : kCases) out.emplace_back(one.name);
  return out;
}

std::vector<Study> run_cases(const StabilityOptions& options, sim::study::Extent extent) {
  std::string current;
  std::unique_ptr<Progress> bar;
  const sim::study::Progress progress = [&](const std::string& work, std::uint64_t done, std::uint64_t total) {
    if (work != current) {
      bar.reset();  // takes its line off the terminal before the next one is drawn
      bar = std::make_unique<Progress>(current = work, total, options.common.progress());
    }
    bar->update(done);
  };
  std::vector<Study> studies;
  for (const Case& one : kCases)
    if (options.cases.empty() || std::find(options.cases.begin(), options.cases.end(), one.name) != options.cases.end())
      studies.push_back(one.run(extent, progress));
  return studies;
}

Outcome write_report(const StabilityOptions& options, sim::study::Extent extent, const std::vector<Study>& studies) {
  const std::string& folder = options.directory;
  std::vector<Picture> pictures;
  bool all_drawn = true;
  for (const StabilityPlot& made : stability_plots(studies)) {
    TACTUS_TRY(const auto drawn, draw(made.plot, folder, options.common.existing()));
    if (drawn == Drawn::yes) pictures.push_back({made.plot.name, made.caption});
    else all_drawn = false;
  }
  if (!all_drawn) fmt::print(stderr, "note: {}\n", kNoGnuplot);
  TACTUS_CHECK(write_file(folder + "/stability.csv", to_csv(studies), options.common.existing()));
  TACTUS_CHECK(write_file(folder + "/stability.json", to_json(studies, extent), options.common.existing()));
  return write_file(folder + "/report.md", to_markdown(studies, pictures, extent), options.common.existing());
}

Outcome run(const StabilityOptions& options) {
  const sim::study::Extent extent = options.brief ? sim::study::Extent::brief : sim::study::Extent::full;
  const bool writes = !options.directory.empty();
  if (writes) {
    TACTUS_CHECK(make_folder(options.directory));
    for (const char* file : {"/report.md", "/stability.csv", "/stability.json"})
      TACTUS_CHECK(OutputFile::check_free(options.directory + file, options.common.existing()));
  }
  const std::vector<Study> studies = run_cases(options, extent);
  if (writes) TACTUS_CHECK(write_report(options, extent, studies));
  if (options.common.json) fmt::print("{}", to_json(studies, extent));
  else if (!options.common.quiet) print_table(studies, stdout);
  return {};
}

}  // namespace

void setup_bench_stability(Command& group, Action& action) {
  auto options = std::make_shared<StabilityOptions>();
  Command& command = group.add_command("stability", "Stability limits of each part beside theory");
  command.add_option("--case", options->cases, "Only this: " + fmt::format("{}", fmt::join(case_names(), ", ")) + " [all]")
      ->one_of(case_names())
      ->type_name("CASE");
  command.add_flag("--short", options->brief, "Run a selection: about 10 s of CPU time instead of 10 minutes");
  command.add_option("-o,--output", options->directory, "Folder for report.md, CSV, JSON and plots")->type_name("DIR");
  add_output_options(command, options->common);
  command.footer("Example:\n  tactus bench stability --short -o stability");
  on_chosen<StabilityOptions>(command, action, options, run);
}

}  // namespace tactus::cli
