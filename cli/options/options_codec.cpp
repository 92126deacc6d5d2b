// SPDX-License-Identifier: Apache-2.0
#include "cli/options/options_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include <tactus/base/rule.h>
#include <tactus/base/text.h>
#include <tactus/rigid/rigid_bounds.h>
#include "cli/progress.h"

namespace tactus::cli {
namespace {

// What the grid of every stream can hold (pose_thresholds() of rigid_bounds.cpp): 8 steps of position and of rotation.
constexpr double kLeastLength = 2e-6, kMostLength = 1e6;        // [m]
constexpr double kLeastAngle = 0.002 * std::numbers::pi / 180;  // [rad]

/// What the encoder takes of a bound, with the usual ones beside it.   in  range  the same in words
Check taken_by_encoder(double RigidTriggers::*bound, Dimension dimension, const std::string& range) {
  const auto look = [=](const std::string& text) {
    const auto typed = parse_quantity(text, dimension);
    if (!typed) return typed.error();
    RigidTriggers triggers;
    triggers.*bound = typed->value;
    return RigidBounds::check(triggers, {}) ? std::string() : fmt::format("'{}': must be {}", text, range);
  };
  return Check(look, range);
}

}  // namespace

void add_encoder_options(Command& app, TriggerArguments& triggers, MeshArguments& deformables) {
  triggers.add_to(app);
  triggers.add_encoder_to(app);
  deformables.add_to(app);
  deformables.add_encoder_to(app);
}

Check whole_number(std::uint64_t low, std::uint64_t high) {
  const auto look = [low, high](const std::string& text) {
    std::uint64_t number = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool fits = status == std::errc() && end == text.data() + text.size() && number >= low && number <= high;
    return fits ? std::string() : fmt::format("'{}': not a whole number from {} to {}", text, low, high);
  };
  return Check(look, fmt::format("{} to {}", low, high));
}

Check number_from(double low) {
  const auto look = [low](const std::string& text) {
    const auto value = parse_number<double>(text);
    return value && *value >= low && std::isfinite(*value) ? std::string()
                                                           : fmt::format("'{}': not a number from {} on", text, low);
  };
  return Check(look, fmt::format("{} or more", low));
}

Check number(double low, double high) {
  const auto look = [low, high](const std::string& text) {
    double value = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool fits = status == std::errc() && end == text.data() + text.size() && value >= low && value <= high;
    return fits ? std::string() : fmt::format("'{}': not a number from {} to {}", text, low, high);
  };
  return Check(look, fmt::format("{} to {}", low, high));
}

Outcome check_no_terminal(const std::string& output) {
  if (output != "-" || !is_terminal(kStandardOutput)) return {};
  return refuse_arguments("-o -: standard output is a terminal, and the output is binary",
                          "Name a file, or redirect the output to a file or to another command.");
}

void add_report_options(Command& app, CommonOptions& options) {
  options.command = &app;
  app.add_flag("--json", options.json, "Report as JSON, in SI units");
  app.add_flag("-q,--quiet", options.quiet, "Print no progress and no table; --json still reports");
  app.add_flag("--no-progress", options.no_progress, "No progress bar");
}

void add_output_options(Command& app, CommonOptions& options) {
  add_report_options(app, options);
  app.add_flag("-f,--force", options.force, "Replace existing output files");
}

void TriggerArguments::add_to(Command& app) {
  const std::map<std::string, HapticRule> rules{{"isotropic", HapticRule::isotropic},
                                                {"cone", HapticRule::cone},
                                                {"fixed", HapticRule::fixed},
                                                {"perceptual", HapticRule::perceptual},
                                                {"off", HapticRule::off}};
  const auto rule = [this, rules](const std::string& name) { triggers_.haptic = rules.at(name); };
  deadband_ = add_quantity(app, "-p,--deadband", triggers_.weber_fraction, Dimension::fraction,
                           "Weber fraction: largest relative error of the normal force in contact [4%]");
  visual_option_ =
      add_pose_bound(app, "--visual", visual_, "Visual threshold: largest shown error of position and rotation [0.3mm,2deg]");
  fixed_option_ = add_pose_bound(app, key("fixed"), fixed_, "Largest pose error in contact with --haptic fixed [1.5mm,2deg]");
  length_unit_option_ =
      add_quantity(app, key("length_unit"), length_unit_, Dimension::length,
                   "Unit of lengths given without one in --visual and --tune fixed [none: lengths need their unit]")
          ->check(above_zero(Dimension::length));
  haptic_ = app.add_option(
                   "--haptic", rule,
                   "Haptic threshold: isotropic (bounds the error of the normal force in all directions alike), cone (bounds its "
                   "amount by -p "
                   "and its direction by --tune alpha), fixed (bounds the pose by --tune fixed), perceptual (isotropic, by the "
                   "fraction that people "
                   "notice: 10 % of 2.5 N to 22 % of 0.3 N) or off [isotropic]")
                ->one_of({"isotropic", "cone", "fixed", "perceptual", "off"})
                ->type_name("RULE");
  alpha_ =
      add_quantity(
          app, key("alpha"), triggers_.cone_angle, Dimension::angle,
          "Largest error of the normal force's direction with --haptic cone [arcsin of -p, what isotropic allows: 2.29deg at 4%]")
          ->check(taken_by_encoder(&RigidTriggers::cone_angle, Dimension::angle, "above 0deg and at most 180deg"));
  jnd_fraction_ =
      add_quantity(app, key("jnd_fraction"), triggers_.perceptual_fraction, Dimension::fraction,
                   "Fraction of the just noticeable difference that --haptic perceptual permits [100%]")
          ->check(taken_by_encoder(&RigidTriggers::perceptual_fraction, Dimension::fraction, "above 0% and at most 100%"));
  floor_ = add_quantity(app, key("force_floor"), triggers_.force_floor, Dimension::force,
                        "Forces below this use the deadband at this force [0.05N]")
               ->check(above_zero(Dimension::force));
  options_ = {deadband_, visual_option_, haptic_, alpha_, jnd_fraction_, fixed_option_, floor_, length_unit_option_};
  app.on_parsed([this] { check_lengths(); });  // only now the length unit is known
}

void TriggerArguments::check_lengths() const {
  check_bound(*visual_option_, visual_);
  check_bound(*fixed_option_, fixed_);
  if (length_unit_option_->count() == 0) {
    for (const auto& [option, bound] : {std::pair(visual_option_, visual_), std::pair(fixed_option_, fixed_)})
      if (bound.length.bare && bound.length.value != 0)
        refuse_option(option->name(), needs_unit(option->last(), Dimension::length));
  }
  if (length_unit_option_->count() > 0 && !visual_.length.bare && !fixed_.length.bare)
    refuse_option(length_unit_option_->name(), "needs a length without a unit in --visual or --tune fixed");
}

void TriggerArguments::check_bound(const Option& option, const PoseBound& bound) const {
  if (option.count() == 0) return;
  if (const double length = scaled(bound.length); !(length >= kLeastLength && length < kMostLength))
    refuse_option(option.name(), fmt::format("a length of {:.3g} mm: must be at least 2um and below 1000000m", 1e3 * length));
  if (!(bound.angle.value >= kLeastAngle && bound.angle.value <= std::numbers::pi))
    refuse_option(option.name(), fmt::format("an angle of {:.3g} rad: must be from 0.002deg to 180deg", bound.angle.value));
}

void TriggerArguments::add_encoder_to(Command& app) {
  options_.push_back(add_quantity(app, key("heartbeat"), triggers_.heartbeat, Dimension::time,
                                  "An object that was not sent for this long is sent again, as a keep-alive; 0: never [1s]")
                         ->check(within(Dimension::time, "0s", "3600s")));
  options_.push_back(add_quantity(app, key("key_interval"), key_interval_, Dimension::time,
                                  "Time between key packets, at which decoding can start; 0: the first only [5s]")
                         ->check(within(Dimension::time, "0s", "86400s")));
  options_.push_back(
      app.add_option(
             key("reduction"), [this](const std::string& typed) { no_reduction_ = typed == "none"; },
             "When an object is sent: dead_reckoning (when what is shown leaves a bound) or none (every object at every "
             "tick) [dead_reckoning]")
          ->one_of({"dead_reckoning", "none"})
          ->type_name("RULE"));
}

std::optional<double> TriggerArguments::weber_fraction(std::optional<double> otherwise) const {
  if (triggers_.haptic == HapticRule::off) return std::nullopt;
  return deadband_->count() > 0 ? triggers_.weber_fraction : otherwise;
}

bool TriggerArguments::any_given() const {
  return std::any_of(options_.begin(), options_.end(), [](const Option* option) { return option->count() > 0; });
}

RigidTriggers TriggerArguments::over(RigidTriggers out) const {
  out.reduction = no_reduction_ ? Reduction::none : Reduction::dead_reckoning;
  out.heartbeat = triggers_.heartbeat;
  if (haptic_->count() > 0) out.haptic = triggers_.haptic;
  if (deadband_->count() > 0) out.weber_fraction = triggers_.weber_fraction;
  if (alpha_->count() > 0) out.cone_angle = triggers_.cone_angle;
  else if (haptic_->count() > 0 && out.haptic == HapticRule::cone) out.cone_angle = isotropic_angle(out.weber_fraction);
  if (jnd_fraction_->count() > 0) out.perceptual_fraction = triggers_.perceptual_fraction;
  if (floor_->count() > 0) out.force_floor = triggers_.force_floor;
  if (visual_option_->count() > 0) {
    out.visual_position = scaled(visual_.length);
    out.visual_rotation = visual_.angle.value;
  }
  if (fixed_option_->count() > 0) {
    out.fixed_position = scaled(fixed_.length);
    out.fixed_rotation = fixed_.angle.value;
  }
  return out;
}

void MotionArguments::add_to(Command& app) {
  const Option* gravity =
      app.add_option(
             key("gravity"), gravity_,
             "Gravity of the recording along -z [m/s^2]: updates may then choose free fall as their predictor [0: none does]")
          ->check(number_from(0))
          ->type_name("G");
  app.add_option(
         key("friction"), friction_,
         "Coefficient of friction of the recording: updates may then choose sliding to rest as their predictor [0: none does]")
      ->check(number_from(0))
      ->type_name("MU")
      ->needs(gravity);
}

void MeshArguments::add_to(Command& app) {
  visual_ = add_quantity(app, "--deformable-visual", thresholds_.visual, Dimension::length,
                         "Visual threshold of a vertex of a deformable object, 0: exact to the grid [0.3mm]")
                ->check(within(Dimension::length, "0m", "1000000m"));
  rings_ =
      app.add_option(key("rings"), coding_.rings,
                     "Area of interest in which -p holds: the touched triangle and this many rings of neighbours around it [3]")
          ->check(whole_number(0, DeformableObject::kMaxRings))
          ->type_name("M");
  options_ = {visual_, rings_};
}

void MeshArguments::add_encoder_to(Command& app) {
  const std::map<std::string, DeformableProfile> profiles{{"thesis", DeformableProfile::thesis},
                                                          {"main", DeformableProfile::main}};
  const auto profile = [this, profiles](const std::string& name) { coding_.profile = profiles.at(name); };
  Option* modes =
      app.add_option("--basis", modes_, "Vibration modes that both ends compute from the mesh, 0: none (--profile main) [0]")
          ->check(whole_number(0, ModeBasis::kMaxModes))
          ->type_name("K");
  fractions_[0] = add_quantity(app, key("visual_fraction"), visual_fraction_, Dimension::fraction,
                               "A packet of a deformable object corrects errors above this fraction of --deformable-visual "
                               "(--profile main) [100%, or 70% for more than 100 shapes/s]")
                      ->check(within(Dimension::fraction, "0.1%", "100%"));
  fractions_[1] = add_quantity(app, key("haptic_fraction"), haptic_fraction_, Dimension::fraction,
                               "The same of -p's bound (--profile main) [as visual_fraction]")
                      ->check(within(Dimension::fraction, "0.1%", "100%"));
  const std::map<std::string, std::uint8_t> nuggets{{"2%", 1}, {"5%", 2}, {"30%", 4}, {"all", 7}};
  const auto nugget = [this, nuggets](const std::string& name) { coding_.weight_sets = nuggets.at(name); };
  options_.insert(
      options_.end(),
      {app.add_option(
              "--profile", profile,
              "Coding tools: thesis (of rigid objects dead reckoning, their true velocities, and jumps that a client may smooth "
              "by "
              "--interpolate) or main (look-ahead velocities, and error smoothing over updates) [main]")
           ->one_of({"thesis", "main"})
           ->type_name("NAME"),
       modes,
       fade_ =
           add_quantity(app, key("fade"), fade_fraction_, Dimension::fraction,
                        "Fraction of the corrections outside the basis that fades per second (with a basis) [98%, or 0% for a "
                        "--deformable-visual of 0.01mm and less]")
               ->check(within(Dimension::fraction, "0%", "100%")),
       app.add_option(
              key("nugget"), nugget,
              "How much of a vertex's movement its neighbours do not share: 2%, 5%, 30%, or all for a choice per packet, at "
              "two to four times the cost (--profile main) [5% with --basis and a --deformable-visual above 0.01mm, else 2%]")
           ->one_of({"2%", "5%", "30%", "all"})
           ->type_name("FRACTION"),
       fractions_[0], fractions_[1],
       app.add_option(key("quant_bits"), coding_.quant_bits, "Bits of the quantiser (--profile thesis) [8]")
           ->check(whole_number(1, DeformableObject::kMaxQuantBits))
           ->type_name("Q"),
       app.add_switch(key("keep_models"), coding_.models_kept,
                      "Keep adapting the entropy models from packet to packet (--profile thesis) [off]"),
       app.add_switch(key("layered"), coding_.layered,
                      "Touched deformable objects: send the haptic layer in its own packet before the visual layer. Costs "
                      "a second header per update; of the payload -15 to 40 % without and -24 to 108 % with a basis, 0 to 27 % "
                      "with --profile "
                      "thesis, over five scenes [off]")});
}

bool MeshArguments::any_given() const {
  return std::any_of(options_.begin(), options_.end(), [](const Option* option) { return option->count() > 0; });
}

DeformableThresholds MeshArguments::over(DeformableThresholds out, const TriggerArguments& triggers) const {
  if (visual_->count() > 0) out.visual = thresholds_.visual;
  out.weber_fraction = triggers.weber_fraction(out.weber_fraction);
  return out;
}

SenderOptions MeshArguments::sender(const TriggerArguments& triggers) const {
  const auto typed = [](const Option* option, double value) {
    return option != nullptr && option->count() > 0 ? std::optional<double>(value) : std::nullopt;
  };
  return {.triggers = triggers.triggers(),
          .deformable = {thresholds(triggers), typed(fractions_[0], visual_fraction_), typed(fractions_[1], haptic_fraction_)},
          .policy = {.key_interval = triggers.key_interval()}};
}

TraceCoding MeshArguments::coding(const TriggerArguments& triggers) const {
  TraceCoding out{.deformable = coding_, .spring_modes = static_cast<std::uint8_t>(modes_)};
  if (fade_ != nullptr && fade_->count() > 0) out.deformable.fade = fade_fraction_;
  if (!is_main() || !triggers.reduces()) out.rigid = RigidProfile::thesis;  // what goes out at every tick needs no smoothing
  return out;
}

Option* add_interpolation(Command& app, ReplicaOptions& options) {
  const std::map<std::string, Interpolation> interpolations{
      {"linear", Interpolation::linear}, {"hermite", Interpolation::hermite}, {"blending", Interpolation::blending}};
  return app.add_flag(
      "--interpolate", "linear",
      [&options, interpolations](const std::string& name) { options.interpolation = interpolations.at(name); },
      {"linear", "hermite", "blending"},
      "Smooth the replica over 75 % of the mean inter-arrival time, 5 to 100 ms. With =hermite on cubics that keep the "
      "velocity, with =blending by projective velocity blending, else linear");
}

}  // namespace tactus::cli
