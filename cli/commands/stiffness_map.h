// SPDX-License-Identifier: Apache-2.0
/// The local stiffness of deformable objects as a table and a picture (thesis figure 4.23).
#pragma once

#include <string>
#include <vector>

#include <tactus/sim/scene/scene.h>
#include "cli/output.h"

namespace tactus::cli {

/// Write position at rest and stiffness of every vertex of the surfaces to FILE (CSV), and one figure per object beside it: as FILE is
/// called for the first, with the object's name added for the others. Where figures cannot be drawn a note says so.
/// in   others  files that the command needs besides
/// err  a file cannot be written, or is there and to be kept; errors of stiffness_map() with the object
Outcome write_stiffness_map(const sim::Scene& scene, const std::string& scene_file, const std::string& file,
                            OutputFile::Existing existing, const std::vector<std::string>& others);

}  // namespace tactus::cli
