// SPDX-License-Identifier: Apache-2.0
/// Limits of stability of each part of the simulation, measured and from theory.
///
///   jury     multi-rate loop at the server             thesis eqs. 4.37, 4.38; figure 4.16
///   wall     sampled virtual wall on a held device     thesis eqs. 2.2 to 2.4; figure 2.2
///   client   force rendering at a client with delay    thesis figure 4.17
///   rigid    towers, stacks, stiff touch, friction; falls, free rotation, masses that differ, walls, rest
///
/// Every study is deterministic.
#pragma once

#include "lab/study/study.h"

namespace tactus::sim::study {

Study study_jury(Extent extent, const Progress& progress);
Study study_wall(Extent extent, const Progress& progress);
Study study_client(Extent extent, const Progress& progress);
Study study_rigid(Extent extent, const Progress& progress);
/// Its rows of what moves freely or meets others.
void add_motion_rows(Study& study, Extent extent, const Progress& progress);

}  // namespace tactus::sim::study
