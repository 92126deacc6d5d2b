// SPDX-License-Identifier: Apache-2.0
/// Options of simulations and sessions: networks, hands, compensation.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include <tactus/sim/link/link.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/simulation.h>
#include "cli/command.h"
#include "cli/options/options_codec.h"

namespace tactus::cli {

// ==== options link ====
// An emulated network as people type it: delay=20ms,jitter=5ms,loss=1%

/// err  a sentence that names the part, what is wrong and what would be right
tl::expected<sim::LinkOptions, std::string> parse_link(std::string_view text);

/// Option that takes such a network.
Option* add_link(Command& app, const std::string& name, sim::LinkOptions& value, const std::string& help);
Option* add_link(Command& app, const std::string& name, std::optional<sim::LinkOptions>& value, const std::string& help);

/// Option that takes bits per second with their unit: 200kbit.
Option* add_bit_rate(Command& app, const std::string& name, double& value, const std::string& help);

/// The parts and their units, for the end of a help text.
const char* link_help();

// ==== options session ====
// Options of what takes part in a session.

/// `--playout adaptive` or a time.
Option* add_playout(Command& app, std::string& value);
/// [us]; nothing: adaptive.   pre  checked by add_playout()
std::optional<std::uint32_t> playout_of(const std::string& value);

/// `--tune client_model_scale=FACTOR`.
Option* add_client_model_scale(Command& app, double& value);

/// `--key FILE`.
Option* add_key(Command& app, std::string& value);

// ==== grip option ====
// The option --grip of commands that simulate.

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

// ==== hand option ====
// The option --grip and the keys duration_scale and tremor of commands that simulate.

/// in  otherwise  what holds without it, for the help
inline Option* add_duration_scale(Command& command, double& scale, const std::string& otherwise) {
  return command
      .add_option(key("duration_scale"), scale,
                  "Time that hands take for each movement, times the scene's: 0.5 is twice as fast [" + otherwise + "]")
      ->check(number(0.1, 10))
      ->type_name("FACTOR");
}
inline Option* add_tremor(Command& command, double& rms, const std::string& otherwise) {
  return add_quantity(command, key("tremor"), rms, Dimension::length,
                      "Tremor of free hands at 8 to 12 Hz, RMS per axis [" + otherwise + "]")
      ->check(within(Dimension::length, "0m", "10mm"));
}

/// Hands of a scene, as typed.
class HandArguments {
 public:
  void add_to(Command& command) {
    add_grip(command, grip_, "the scene's");
    scale_option_ = add_duration_scale(command, duration_scale_, "1");
    tremor_option_ = add_tremor(command, tremor_, "the scene's");
  }
  void apply(sim::Scene& scene) const {
    if (scale_option_->count() > 0) sim::scale_durations(scene, duration_scale_);
    if (tremor_option_->count() > 0) sim::set_tremor(scene, tremor_);
  }
  std::optional<sim::Grip> grip() const { return grip_.empty() ? std::nullopt : std::optional(grip_of(grip_)); }

 private:
  std::string grip_;
  double duration_scale_ = 1, tremor_ = 0;  // [m]
  const Option *scale_option_ = nullptr, *tremor_option_ = nullptr;
};

// ==== compensation option ====
// The option --compensation of commands that simulate.

/// in   clients  none, or a method of CompensationMethod; empty: what the scene says
inline void compensate(sim::Scene& scene, const std::string& clients) {
  if (clients.empty()) return;
  if (clients == "none") return scene.compensation.reset();
  if (!scene.compensation) scene.compensation.emplace();
  scene.compensation->method = clients == "stiffness"          ? sim::CompensationMethod::stiffness
                               : clients == "stiffness-thesis" ? sim::CompensationMethod::stiffness_thesis
                                                               : sim::CompensationMethod::simulation;
}

inline Option* add_compensation(Command& command, std::string& clients) {
  return command
      .add_option("--compensation", clients,
                  "What clients do about delay: none, stiffness (render what they touch softer), stiffness-thesis (by the "
                  "thesis's algorithm as printed) or simulation (simulate the scene "
                  "themselves; the server corrects them) [the scene's]")
      ->one_of({"none", "stiffness", "stiffness-thesis", "simulation"})
      ->type_name("CLIENTS");
}

}  // namespace tactus::cli
