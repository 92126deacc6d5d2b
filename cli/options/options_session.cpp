// SPDX-License-Identifier: Apache-2.0
#include "cli/options/options_session.h"

#include <cmath>

#include "cli/options/options_codec.h"
#include "cli/options/units.h"

namespace tactus::cli {

Option* add_playout(Command& app, std::string& value) {
  const auto read = [&value](const std::string& text) {
    if (text != "adaptive") {
      const auto time = parse_quantity(text, Dimension::time);
      if (!time) refuse_option("--playout", time.error() + ", or adaptive");
      if (!(time->value >= 0 && time->value <= 2)) refuse_option("--playout", "'" + text + "': from 0 to 2s, or adaptive");
    }
    value = text;
  };
  return app
      .add_option(
          "--playout", read,
          "How long after the fastest packet a client shows a tick: a time, or adaptive, which waits for nearly all [adaptive]")
      ->type_name("TIME");
}

std::optional<std::uint32_t> playout_of(const std::string& value) {
  if (value == "adaptive") return std::nullopt;
  return static_cast<std::uint32_t>(std::llround(1e6 * parse_quantity(value, Dimension::time)->value));
}

Option* add_told(Command& app, double& value) {
  return app
      .add_option("--told", value,
                  "Mass and stiffness that clients are told of what their devices move, times the true ones, to see what a wrong "
                  "model costs; 0: they are told none [1]")
      ->check(number(0, 1e3))
      ->type_name("FACTOR");
}

Option* add_key(Command& app, std::string& value) {
  return app.add_option("--key", value, "Seal the session with this key, the same at both ends; see `tactus key` [not sealed]")
      ->type_name("FILE");
}

}  // namespace tactus::cli
