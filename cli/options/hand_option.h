// SPDX-License-Identifier: Apache-2.0
/// The options --grip, --pace and --tremor of commands that simulate.
#pragma once

#include <optional>
#include <string>

#include <tactus/sim/scene/scene.h>
#include "cli/options/grip_option.h"
#include "cli/options/options_codec.h"

namespace tactus::cli {

/// in  otherwise  what holds without it, for the help
inline Option* add_pace(Command& command, double& pace, const std::string& otherwise) {
  return command
      .add_option("--pace", pace,
                  "Time that hands take for each movement, times the scene's: 0.5 is twice as fast [" + otherwise + "]")
      ->check(number(0.1, 10))
      ->type_name("FACTOR");
}
inline Option* add_tremor(Command& command, double& rms, const std::string& otherwise) {
  return add_quantity(command, "--tremor", rms, Dimension::length,
                      "Tremor of free hands at 8 to 12 Hz, RMS per axis [" + otherwise + "]")
      ->check(within(Dimension::length, "0m", "10mm"));
}

/// Hands of a scene, as typed.
class HandArguments {
 public:
  void add_to(Command& command) {
    add_grip(command, grip_, "the scene's");
    pace_option_ = add_pace(command, pace_, "1");
    tremor_option_ = add_tremor(command, tremor_, "the scene's");
  }
  void apply(sim::Scene& scene) const {
    if (pace_option_->count() > 0) sim::set_pace(scene, pace_);
    if (tremor_option_->count() > 0) sim::set_tremor(scene, tremor_);
  }
  std::optional<sim::Grip> grip() const { return grip_.empty() ? std::nullopt : std::optional(grip_of(grip_)); }

 private:
  std::string grip_;
  double pace_ = 1, tremor_ = 0;  // [m]
  const Option *pace_option_ = nullptr, *tremor_option_ = nullptr;
};

}  // namespace tactus::cli
