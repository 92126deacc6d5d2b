// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lab/study/study.h"

namespace tactus::sim::study {

/// Deformable objects: extremes for every method, the explicit limit against 2 / omega_max, a map over E and h.
Study study_fem(Extent extent, const Progress& progress);

}  // namespace tactus::sim::study
