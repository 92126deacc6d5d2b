// SPDX-License-Identifier: Apache-2.0
/// Weights of the vertices that predict another: kriging. spec/50-deformable.md section 4.4. Internal to the library.
///
/// The results are integers in the written order. Doubles are an aid inside: a quotient is estimated by a reciprocal and then
/// corrected by its remainder, and the root of an integer below 2^52 is exact.
#pragma once

#include <tactus/mesh/graph.h>

namespace tactus {

/// Parents with weights of one set, by index in `order.order`. Vertices that nearly coincide leave only the nearest one.
/// time 0.5 us per vertex, allocates
ListOfLists<VertexParent> weighted_parents(const DeformableObject& object, const CodingOrder& order, unsigned set);

}  // namespace tactus
