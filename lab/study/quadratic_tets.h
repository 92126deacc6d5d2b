// SPDX-License-Identifier: Apache-2.0
/// Ten-node tetrahedra (displacement quadratic, edges straight), linear elasticity: the reference for linear tetrahedra. They do not lock
/// in bending, so a coarse mesh of them is closer to the truth than the finest one of linear elements.
#pragma once

#include "lab/study/precision_scene.h"

namespace tactus::sim::study {

/// The mesh of `scene` with a node in the middle of every edge; fixed where both ends are. The load is spread evenly over the surface
/// triangles between the patch's vertices, the deflection averaged over them.
/// time one factorisation; about eight times as many nodes as vertices
/// out  mean z displacement of the patch per newton [m/N]
/// err  R-FEM-7 when too little is fixed
tl::expected<double, Diagnostic> quadratic_static_deflection(const PrecisionScene& scene);

}  // namespace tactus::sim::study
