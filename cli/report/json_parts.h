// SPDX-License-Identifier: Apache-2.0
/// Parts of values that several commands print: cli/schemas/parts.json.
#pragma once

#include <string>

#include "cli/report/report.h"

namespace tactus::cli {

struct Value;

/// in   seconds  of the recording, 0: there is none
Value time_value(const StepTimes& times, double seconds);
Value rigid_traffic_value(const Report& report);  ///< pre  it has traffic
Value load_traffic_value(const LoadRates& traffic, double seconds);
Value mesh_traffic_value(const MeshReport& mesh, double seconds);
Value stream_value(const Report& report);  ///< pre  it has a stream
Value bounds_value(const RigidTriggers& bounds);
/// in   promised  false: the bounds only decide what is sent
Value mesh_bounds_value(const DeformableThresholds& bounds, std::uint8_t rings, bool promised);
Value widening_value(const Widening& widened);

/// {"error": ...}, schema error.json
std::string error_json(const Failure& failure);

}  // namespace tactus::cli
