// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "cli/laboratory/cmd_bench.h"
#include "cli/laboratory/precision_report.h"
#include "cli/options/options_codec.h"
#include "cli/progress.h"

namespace tactus::cli {
namespace {

/// Steps below 1 ms of a method that is this many times slower than real time are left out.
constexpr double kTooSlow = 2, kAlwaysComputed = 1e-3 * (1 - 1e-9);

struct PrecisionOptions {
  std::vector<std::string> scenes;
  std::string folder;
  bool brief = false;
  int runs = 5;
  CommonOptions common;

  sim::study::Extent extent() const { return brief ? sim::study::Extent::brief : sim::study::Extent::full; }
};

Failure failure_of(const std::string& scene, const Diagnostic& error) { return {scene + ": " + to_string(error), ""}; }

/// All points of the studies; those that are in the results already are not computed again.
class Work {
 public:
  Work(const PrecisionOptions& options, PrecisionResults& results) : options_(options), results_(results) {
    for (const std::string& name : options.scenes) {
      scenes_.push_back(*sim::study::precision_scene(name, options.extent()));
      total_ += 1 + methods_.size() * scenes_.back().steps_per_sample.size() + space_jobs(name).size();
    }
    progress_.emplace("bench precision", total_, options.common.progress());
  }

  tl::expected<PrecisionReport, Failure> run();

 private:
  std::vector<sim::study::SpaceJob> space_jobs(const std::string& scene) const {
    // A stiffer material of the same shape has the same relative space error.
    if (scene == "membrane-stiff") return {};
    return sim::study::space_jobs(scene, options_.extent());
  }
  tl::expected<TimeStudy, Failure> time_study(const sim::study::PrecisionScene& scene);
  Outcome space_studies(const std::string& scene, std::vector<SpaceStudy>& out);
  tl::expected<sim::study::PrecisionPoint, Failure> point(const sim::study::PrecisionScene& scene,
                                                          const sim::study::PrecisionMethod& method, int steps);
  tl::expected<sim::study::Reference, Failure> reference(const sim::study::PrecisionScene& scene);
  void count() { progress_->update(++done_); }

  const PrecisionOptions& options_;
  PrecisionResults& results_;
  std::vector<sim::study::PrecisionScene> scenes_;
  std::vector<sim::study::PrecisionMethod> methods_ = sim::study::precision_methods(options_.extent());
  std::optional<sim::study::Reference> reference_;  // of reference_scene_, made when a point needs it
  std::string reference_scene_;
  std::uint64_t total_ = 0, done_ = 0;
  std::optional<Progress> progress_;
};

tl::expected<sim::study::Reference, Failure> Work::reference(const sim::study::PrecisionScene& scene) {
  auto reference = sim::study::make_reference(scene);
  if (!reference) return tl::unexpected(failure_of(scene.name, reference.error()));
  if (results_.find(scene.name, kReferenceMethod, scene.reference_steps_per_sample) == nullptr) {
    sim::study::PrecisionPoint point;
    point.method = kReferenceMethod;
    point.steps_per_sample = scene.reference_steps_per_sample;
    point.step = reference->step;
    point.errors = reference->floor;
    point.seconds_per_second = reference->load.step_seconds / scene.duration;
    point.runs = 1;
    point.remark = fmt::format("observed order {:.2f}", reference->order);
    TACTUS_CHECK(results_.add(TimeRow{scene.name, point}));
  }
  return *std::move(reference);
}

/// The point, computed if it is not known yet.
tl::expected<sim::study::PrecisionPoint, Failure> Work::point(const sim::study::PrecisionScene& scene,
                                                              const sim::study::PrecisionMethod& method, int steps) {
  if (const TimeRow* row = results_.find(scene.name, method.name, steps)) return row->point;
  if (!reference_ || reference_scene_ != scene.name) {
    TACTUS_TRY(auto made, reference(scene));
    reference_ = std::move(made);
    reference_scene_ = scene.name;
  }
  const auto point = sim::study::measure(scene, method, steps, *reference_, {.runs = options_.runs});
  TACTUS_CHECK(results_.add(TimeRow{scene.name, point}));
  return results_.find(scene.name, method.name, steps)->point;
}

tl::expected<TimeStudy, Failure> Work::time_study(const sim::study::PrecisionScene& scene) {
  TimeStudy out{scene, {}, methods_, {}};
  for (const sim::study::PrecisionMethod& method : methods_) {
    double cost = 0;
    for (const int steps : scene.steps_per_sample) {
      count();
      if (cost > kTooSlow && scene.step(steps) < kAlwaysComputed) continue;
      TACTUS_TRY(const auto point, this->point(scene, method, steps));
      cost = point.seconds_per_second;
      out.points.push_back(point);
    }
  }
  out.reference = results_.find(scene.name, kReferenceMethod, scene.reference_steps_per_sample)->point;
  count();
  return out;
}

Outcome Work::space_studies(const std::string& scene, std::vector<SpaceStudy>& out) {
  for (const sim::study::SpaceJob& job : space_jobs(scene)) {
    const SpaceRow* row = results_.find(scene, job);
    if (row == nullptr) {
      const auto point = sim::study::measure_space(scene, job);
      if (!point) return tl::unexpected(failure_of(scene, point.error()));
      TACTUS_CHECK(results_.add(SpaceRow{scene, *point}));
      row = results_.find(scene, job);
    }
    if (job.refinement == 1) out.push_back({scene, {}, {}});
    out.back().points.push_back(row->point);
    count();
  }
  for (SpaceStudy& space : out)
    if (space.scene == scene) space.errors = sim::study::space_errors(space.points);
  return {};
}

tl::expected<PrecisionReport, Failure> Work::run() {
  PrecisionReport report{results_.context(), {}, {}};
  for (const sim::study::PrecisionScene& scene : scenes_) {
    TACTUS_TRY(auto time, time_study(scene));
    report.times.push_back(std::move(time));
    TACTUS_CHECK(space_studies(scene.name, report.spaces));
  }
  return report;
}

/// All files but the two that grew on the way.
Outcome write_report(const PrecisionReport& report, const std::string& folder) {
  constexpr auto kReplace = OutputFile::Existing::replace;
  TACTUS_CHECK(write_file(folder + "/precision.json", precision_json(report), kReplace));
  TACTUS_CHECK(write_file(folder + "/report.md", precision_markdown(report), kReplace));
  for (const Plot& plot : precision_plots(report)) {
    TACTUS_TRY(const auto drawn, draw(plot, folder, kReplace));
    if (drawn == Drawn::no) {
      fmt::print(stderr, "{}\n", kNoGnuplot);
      break;
    }
  }
  return {};
}

Outcome run(const PrecisionOptions& options) {
  PrecisionOptions chosen = options;
  if (chosen.scenes.empty())
    chosen.scenes.assign(std::begin(sim::study::kPrecisionScenes), std::end(sim::study::kPrecisionScenes));
  auto context = bench_context();
  context["extent"] = options.brief ? "short" : "full";
  context["runs"] = fmt::to_string(options.runs);
  TACTUS_TRY(auto results, PrecisionResults::open(options.folder, std::move(context), options.common.existing()));
  TACTUS_TRY(const auto report, Work(chosen, results).run());
  TACTUS_CHECK(write_report(report, options.folder));
  if (options.common.json) fmt::print("{}", precision_json(report));
  else if (!options.common.quiet) print_precision_tables(report);
  return {};
}

}  // namespace

void setup_bench_precision(Command& group, Action& action) {
  auto options = std::make_shared<PrecisionOptions>();
  Command& command = group.add_command("precision", "Error against run time: methods, solvers and step sizes");
  const std::vector<std::string> names(std::begin(sim::study::kPrecisionScenes), std::end(sim::study::kPrecisionScenes));
  command.add_option("--scene", options->scenes, "membrane, membrane-stiff or cantilever; may be repeated [all]")
      ->one_of(names)
      ->type_name("SCENE");
  command.add_option("-o,--output", options->folder, "Folder for report, tables and plots; a stopped run is resumed")
      ->required()
      ->type_name("DIR");
  command.add_flag("--short", options->brief,
                   "Coarse meshes and few steps: about 30 s of CPU time with --runs 1 instead of half an hour");
  command.add_option("--runs", options->runs, "Runs per measured time; the median is reported")
      ->show_default()
      ->check(whole_number(1, 1000))
      ->type_name("N");
  add_output_options(command, options->common);
  command.footer("Example:\n  tactus bench precision --scene membrane -o out/precision");
  on_chosen<PrecisionOptions>(command, action, options, run);
}

}  // namespace tactus::cli
