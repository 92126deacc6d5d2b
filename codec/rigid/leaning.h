// SPDX-License-Identifier: Apache-2.0
/// A velocity for an update that makes it last longer: it leans towards the acceleration, so that the error of the prediction first goes
/// to one side of its bounds and then to the other. Informative: an encoder's choice; a decoder sees a velocity like any other. Internal
/// to the library.
///
///   v' = v + s a,  w' = w + s alpha                                    for all of one object the same s
///
/// The truth is taken to go on with an acceleration that fades, a e^(-t/tau): it departs from v by a g(t),
/// g(t) = tau (t - tau (1 - e^(-t/tau))), and the prediction departs from the truth by a (s t - g(t)). Its largest value on the one side is, with x = s/tau,
///   tau^2 ((1 - x) ln(1 - x) + x),  and shall be B = the smallest of permitted error over acceleration;
/// x = y - y^2/6, at most 1, with y = sqrt(2 B)/tau, is within 7 % of that. For small B an update then lasts 1 + sqrt(2) times as long as
/// with s = 0. What the truth really does decides how long it lasts, never whether a bound holds.
#pragma once

#include <tactus/rigid/acceleration.h>
#include <tactus/rigid/error_share.h>

namespace tactus {

/// The velocities to tell, less the true ones [m/s, rad/s].   time about 30 ns
Acceleration::Motion leaning(const Acceleration::Motion& acceleration, const ErrorShare& share) noexcept;

}  // namespace tactus
