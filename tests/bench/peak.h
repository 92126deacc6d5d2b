// SPDX-License-Identifier: Apache-2.0
/// What this machine can compute: additions and multiplications of doubles, none waiting for another, without contraction.
#pragma once

#include <tactus/sim/fem/element_block.h>

namespace tactus::testing {

/// [flop/s] of one thread in CPU time, the best of some short runs.   pre  supported(set)   time 0.1 s
double peak(sim::InstructionSet set);

}  // namespace tactus::testing
