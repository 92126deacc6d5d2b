// SPDX-License-Identifier: Apache-2.0
/// What the JSON of several commands has in common.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "cli/report/messages.h"
#include "cli/report/step_times.h"

namespace tactus::cli {

/// in   seconds  of the recording, 0: there is none
nlohmann::ordered_json time_json(const StepTimes& times, double seconds);

/// {"error": ...}, schema error.json
std::string error_json(const Failure& failure);

/// As printed: indented, and text that is no UTF-8 made so.
std::string text_of_json(const nlohmann::ordered_json& json);

}  // namespace tactus::cli
