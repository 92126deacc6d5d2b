// SPDX-License-Identifier: Apache-2.0
/// The option --compensation of commands that simulate.
#pragma once

#include <string>

#include <tactus/sim/scene/scene.h>
#include "cli/options/options_codec.h"

namespace tactus::cli {

/// in   clients  none, stiffness, simulation; empty: what the scene says
inline void compensate(sim::Scene& scene, const std::string& clients) {
  if (clients.empty()) return;
  if (clients == "none") return scene.compensation.reset();
  if (!scene.compensation) scene.compensation.emplace();
  scene.compensation->method = clients == "stiffness" ? sim::CompensationMethod::stiffness : sim::CompensationMethod::simulation;
}

inline Option* add_compensation(Command& command, std::string& clients) {
  return command
      .add_option(
          "--compensation", clients,
          "What clients do about delay: none, stiffness (render what they touch softer) or simulation (simulate the scene "
          "themselves; the server corrects them) [the scene's]")
      ->one_of({"none", "stiffness", "simulation"})
      ->type_name("CLIENTS");
}

}  // namespace tactus::cli
