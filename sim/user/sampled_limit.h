// SPDX-License-Identifier: Apache-2.0
/// Stability limit of a virtual hand on a coupling: sampling and smoothing of the device delay the force felt.
#pragma once

#include <tactus/sim/user/hand.h>

namespace tactus::sim {

/// Largest stable stiffness k [N/m] of a spring from hand and device to a fixed point. For the simulated loop
///   m (x+ - 2 x + x-) / T^2 = -k_h x - b (x - x-) / T - k F x,   F the device's mean of N samples,
/// it is the least k with a pole on the unit circle, about b / ((N - 1) T / 2) where that is far above k_h. An object that yields
/// allows more.
/// time 40 us for N = 8, 2 ms for 1000
double sampled_limit(const HandImpedance& hand, const SceneDevice& device) noexcept;

}  // namespace tactus::sim
