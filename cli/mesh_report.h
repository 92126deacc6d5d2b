// SPDX-License-Identifier: Apache-2.0
/// What a report tells of one deformable object.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "cli/step_times.h"
#include "cli/table.h"
#include "codec/trace/mesh_fidelity.h"
#include "codec/trace/mesh_link.h"

namespace tactus::cli {

struct MeshReport {
  std::string name;
  std::size_t vertices = 0;
  std::optional<MeshTraffic> traffic{};
  std::optional<MeshFidelity> fidelity{};
  StepTimes encode{}, decode{};
};

/// Send one shape through the link and measure.
/// in   frame  whose mesh `index` is new
/// out  the packets, valid until the link's next encode().   err  of encoder or decoder
Result<MeshPackets> transmit(MeshLink& link, const TraceFrame& frame, std::size_t index, MeshReport& report);

void mesh_rows(Table& table, const MeshReport& mesh, double seconds);
nlohmann::ordered_json mesh_json(const MeshReport& mesh, double seconds);

}  // namespace tactus::cli
