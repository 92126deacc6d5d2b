// SPDX-License-Identifier: Apache-2.0
/// How stiff a coupling a virtual hand bears: sampling and smoothing of the device delay what it feels.
#pragma once

#include <tactus/sim/user/hand.h>

namespace tactus::sim {

/// Largest k [N/m] of a spring to a fixed point that hand and device do not swing up against. Of the loop as it is simulated,
///   m (x+ - 2 x + x-) / T^2 = -k_h x - b (x - x-) / T - k F x,   F the device's mean of N samples,
/// the least k with a pole on the unit circle. About b / ((N - 1) T / 2) where that is far above k_h. What gives way
/// bears more.
/// time 40 us for N = 8, 2 ms for 1000
double sampled_limit(const HandImpedance& hand, const SceneDevice& device) noexcept;

}  // namespace tactus::sim
