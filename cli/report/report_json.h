// SPDX-License-Identifier: Apache-2.0
/// Parts of the reports' JSON that other commands print too.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "cli/report/report.h"

namespace tactus::cli {

nlohmann::ordered_json rigid_traffic_json(const Report& report);  ///< pre  it has traffic
nlohmann::ordered_json load_traffic_json(const LoadRates& traffic, double seconds);
nlohmann::ordered_json mesh_traffic_json(const MeshReport& mesh, double seconds);
nlohmann::ordered_json stream_json(const Report& report);  ///< pre  it has a stream
nlohmann::ordered_json bounds_json(const RigidTriggers& bounds);

}  // namespace tactus::cli
