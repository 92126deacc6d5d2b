// SPDX-License-Identifier: Apache-2.0
/// An emulated network as people type it: delay=20ms,jitter=5ms,loss=1%
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include <tactus/sim/link/link.h>
#include "cli/command.h"

namespace tactus::cli {

/// err  a sentence that names the part, what is wrong and what would be right
tl::expected<sim::LinkOptions, std::string> parse_link(std::string_view text);

/// Option that takes such a network.
Option* add_link(Command& app, const std::string& name, sim::LinkOptions& value, const std::string& help);
Option* add_link(Command& app, const std::string& name, std::optional<sim::LinkOptions>& value, const std::string& help);

/// Option that takes bits per second with their unit: 200kbit.
Option* add_bit_rate(Command& app, const std::string& name, double& value, const std::string& help);

/// The parts and their units, for the end of a help text.
const char* link_help();

}  // namespace tactus::cli
