// SPDX-License-Identifier: Apache-2.0
/// Options of what takes part in a session.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "cli/command.h"

namespace tactus::cli {

/// `--playout adaptive` or a time.
Option* add_playout(Command& app, std::string& value);
/// [us]; nothing: adaptive.   pre  checked by add_playout()
std::optional<std::uint32_t> playout_of(const std::string& value);

/// `--told FACTOR`.
Option* add_told(Command& app, double& value);

/// `--key FILE`.
Option* add_key(Command& app, std::string& value);

}  // namespace tactus::cli
