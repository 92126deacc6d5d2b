// SPDX-License-Identifier: Apache-2.0
/// The option --grip of commands that simulate.
#pragma once

#include <string>

#include <tactus/sim/simulation.h>
#include "cli/options/options_codec.h"

namespace tactus::cli {

/// pre  add_grip() took this name
inline sim::Grip grip_of(const std::string& name) {
  return name == "loose" ? sim::Grip::loose : name == "firm" ? sim::Grip::firm : sim::Grip::normal;
}

/// in  otherwise  what holds without it, for the help
inline Option* add_grip(Command& command, std::string& grip, const std::string& otherwise) {
  return command.add_option("--grip", grip, "Grip of the hand on the device: loose, normal or firm [" + otherwise + "]")
      ->one_of({"loose", "normal", "firm"})
      ->type_name("GRIP");
}

}  // namespace tactus::cli
