// SPDX-License-Identifier: Apache-2.0
/// What a report tells of one deformable object.
#pragma once

#include <optional>
#include <string>

#include <tactus/metrics/deformable_errors.h>
#include <tactus/metrics/rates.h>
#include "cli/report/step_times.h"

namespace tactus::cli {

struct MeshReport {
  std::string name;
  std::size_t vertices = 0, triangles = 0;  ///< triangles 0: not said
  std::optional<DeformableRates> traffic{};
  std::optional<DeformableErrors> fidelity{};
  std::uint64_t frames = 0;  ///< written or read; 0: not said
  double frame_period = 0;   ///< [s] from one to the next, if frames
  bool promised = true;      ///< the bounds are: false where they only decide what is sent
  StepTimes encode{}, decode{};
};

/// With `header` bytes below each packet.
inline double bytes_of(const DeformableRates& t, std::uint64_t header) {
  return static_cast<double>(t.bytes + t.sizes.size() * header);
}
/// Every frame as three floats per vertex.
inline double raw_bytes(const MeshReport& mesh) { return 12.0 * static_cast<double>(mesh.vertices * mesh.traffic->frames); }
inline bool has_layers(const DeformableRates& t) { return t.layers[0].packets + t.layers[1].packets > 0; }

}  // namespace tactus::cli
