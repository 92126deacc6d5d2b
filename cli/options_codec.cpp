// SPDX-License-Identifier: Apache-2.0
#include "cli/options_codec.h"

#include <algorithm>
#include <map>
#include <string>

namespace tactus::cli {

CLI::Validator one_of(const std::vector<std::string>& names) { return CLI::IsMember(names).description(""); }

void add_report_options(CLI::App& app, CommonOptions& options) {
  app.add_flag("--json", options.json, "Report as JSON, in SI units");
  app.add_flag("-q,--quiet", options.quiet, "No progress and no table; --json still reports");
  app.add_flag("--no-progress", options.no_progress, "No progress bar");
}

void add_output_options(CLI::App& app, CommonOptions& options) {
  add_report_options(app, options);
  app.add_flag("-f,--force", options.force, "Replace output files that are there already");
}

void TriggerArguments::add_to(CLI::App& app) {
  const std::map<std::string, HapticRule> rules{
      {"isotropic", HapticRule::isotropic}, {"cone", HapticRule::cone}, {"fixed", HapticRule::fixed}, {"off", HapticRule::off}};
  const auto rule = [this, rules](const std::string& name) { triggers_.haptic = rules.at(name); };
  options_ = {
      add_quantity(app, "-p,--deadband", triggers_.weber_fraction, Dimension::fraction,
                   "Permitted share of force error, Weber's law [8%]"),
      add_pose_bound(app, "--visual", visual_, "Permitted error of pose to the eye [0.006,2deg]"),
      app.add_option_function<std::string>("--haptic", rule,
                                           "Permitted error of force: isotropic, cone, fixed or off [isotropic]")
          ->check(one_of({"isotropic", "cone", "fixed", "off"}))
          ->type_name("RULE"),
      add_quantity(app, "--alpha", triggers_.cone_angle, Dimension::angle,
                   "Permitted force direction error of the rule cone [2.1deg]"),
      add_pose_bound(app, "--fixed", fixed_, "Permitted pose error in contact of the rule fixed [0.0015,2deg]"),
      add_quantity(app, "--force-floor", triggers_.force_floor, Dimension::force,
                   "Below this force the deadband is that of it [0.05N]"),
      add_quantity(app, "--length-unit", length_unit_, Dimension::length, "Metres per unit of lengths typed without a unit [1m]"),
  };
}

void TriggerArguments::add_encoder_to(CLI::App& app) {
  options_.push_back(
      add_quantity(app, "--heartbeat", triggers_.heartbeat, Dimension::time, "Longest silence, 0: unlimited [1s]"));
  options_.push_back(
      add_quantity(app, "--key-interval", key_interval_, Dimension::time, "Time between places to seek to, 0: first only [5s]"));
  options_.push_back(app.add_flag("--no-reduction", no_reduction_, "Send every object in every tick"));
  options_.push_back(
      app.add_option("--profile", "Set of coding tools: thesis [thesis]")->check(one_of({"thesis"}))->type_name("NAME"));
}

bool TriggerArguments::any_given() const {
  return std::any_of(options_.begin(), options_.end(), [](const CLI::Option* option) { return option->count() > 0; });
}

RigidTriggers TriggerArguments::triggers() const {
  RigidTriggers out = triggers_;
  out.reduction = no_reduction_ ? Reduction::none : Reduction::dead_reckoning;
  out.visual_position = scaled(visual_.length);
  out.visual_rotation = visual_.angle.value;
  out.fixed_position = scaled(fixed_.length);
  out.fixed_rotation = fixed_.angle.value;
  return out;
}

CLI::Option* add_interpolation(CLI::App& app, ReplicaOptions& options) {
  return app.add_flag_callback(
      "--interpolate", [&options] { options.interpolation = Interpolation::linear; },
      "Smooth the replica: straight line and SLERP over 75 % of the usual gap, 5 to 100 ms");
}

}  // namespace tactus::cli
