// SPDX-License-Identifier: Apache-2.0
/// How a user's session over an emulated network went: what it cost, and how far what the client showed was from the truth of that tick.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <tactus/metrics/errors.h>
#include <tactus/session/session_client.h>
#include "cli/report/mesh_report.h"

namespace tactus::cli {

/// One direction: what an end sent, and what the network did to it.
struct DirectionReport {
  Traffic traffic{};                                                ///< of the end that sends
  std::uint64_t sent = 0, lost = 0, duplicated = 0, overtaken = 0;  ///< datagrams
};

struct NetworkReport {
  std::string user;
  ErrorMetrics errors;               ///< of what was shown against the truth of the tick shown
  std::vector<MeshReport> meshes{};  ///< the same, of deformable objects
  std::uint64_t not_shown = 0;       ///< ticks in which the client had nothing to show
  std::uint64_t without_force = 0;   ///< ticks in which old data kept the client from rendering its full force
  double delay_sum = 0;              ///< [s] of the ticks shown, behind the server's
  std::uint64_t shown = 0;
  SessionStatus status{};
  Widening widened{};  ///< of the bounds, by the server
  DirectionReport up{}, down{};
};

}  // namespace tactus::cli
