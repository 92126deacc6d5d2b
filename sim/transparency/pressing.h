// SPDX-License-Identifier: Apache-2.0
/// Users press a one-dimensional deformable object through a network that delays: what they feel, with and without a client that makes
/// up for the delay. Thesis figures 4.18, 4.21 and 4.24.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/client/stiffness_reduction.h>
#include <tactus/sim/msd/msd.h>

namespace tactus::sim {

/// A hand goes in along a quarter of a sine, holds still, and comes out as it went in.
struct Press {
  double begin = 0;  ///< [s] at the surface at rest
  double hold = 0;   ///< [s] from the deepest point on
  double end = 0;    ///< [s] begins to come out
  double depth = 0;  ///< [m]
};

/// [m] Into the object, at a time [s]; below zero: outside.   in  frequency [Hz] of the sine
double depth_of(const std::vector<Press>& presses, double time, double frequency) noexcept;

struct PressingUser {
  std::vector<Press> presses{};
  std::uint32_t to_server = 0, from_server = 0;  ///< T_f, T_b [ticks]
};

struct Pressing {
  MsdObject object{};
  double stiffness = 0;       ///< [N/m] k_c = k_s
  double client_damping = 0;  ///< [N s/m] b_c
  double frequency = 0.5;     ///< [Hz]
  double duration = 0;        ///< [s]
  std::vector<PressingUser> users{};
  std::optional<double> compensation{};  ///< lambda of StiffnessReduction; none: the client renders k_c
};

/// Of a user, tick by tick at 1 kHz, against the hand.
struct Felt {
  std::vector<double> client;  ///< [N] what the hand feels
  std::vector<double> server;  ///< [N] rendered at the server from what arrived there
};

/// err  invalid_argument R-API-4: a delay is longer than StiffnessReduction::kMostDelay, lambda
/// time O(users * duration)
Result<std::vector<Felt>> press(const Pressing& pressing);

}  // namespace tactus::sim
