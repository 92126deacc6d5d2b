// SPDX-License-Identifier: Apache-2.0
/// What delay does to the impedance that a client renders of a deformable object simulated at the server, how much of it nobody feels,
/// and which stiffness hides the rest (thesis, section 4.3). One axis; the object is a damped spring with a mass.
#pragma once

#include <complex>
#include <optional>

namespace tactus::sim {

/// A client at a deformable object.   figure 4.19
struct DeformableCoupling {
  double object_stiffness = 0;  ///< [N/m] k_o > 0 at the touched point
  double object_damping = 0;    ///< [N s/m] b_o
  double object_mass = 0;       ///< [kg] m_o
  double client_stiffness = 0;  ///< [N/m] k_c
  double client_damping = 0;    ///< [N s/m] b_c
  double server_stiffness = 0;  ///< [N/m] k_s > 0
};

/// K_i(s): the object's position by the probe's at the server, at s = j omega.   4.39
std::complex<double> follows(const DeformableCoupling& coupling, double omega) noexcept;
/// K_i, the same at low frequencies.   4.44
double follows_slowly(const DeformableCoupling& coupling) noexcept;

/// [N s/m] Force by the velocity of the device.   in  omega [rad/s] > 0, round_trip [s]   4.39, 4.42
std::complex<double> client_impedance(const DeformableCoupling& coupling, double omega, double round_trip) noexcept;
/// [N s/m] what the client should render.   4.40, 4.42
std::complex<double> server_impedance(const DeformableCoupling& coupling, double omega) noexcept;
/// [N s/m] With K_i instead of K_i(s).   4.39, 4.44
std::complex<double> slow_client_impedance(const DeformableCoupling& coupling, double omega, double round_trip) noexcept;

/// [s] Round trip at which the client's impedance is a share `weber` above the server's, both with K_i and with k_c = k_s; none: it is so
/// at every delay (the client's damping alone does it), or at none.
/// in   omega [rad/s] > 0      4.45
std::optional<double> tolerable_delay(const DeformableCoupling& coupling, double omega, double weber) noexcept;

/// [N/m] Client stiffness with which the client's impedance has the magnitude of the server's, both with K_i; never below zero.
/// in   omega [rad/s] > 0, round_trip [s] < pi/omega      4.46
double reduced_stiffness(const DeformableCoupling& coupling, double omega, double round_trip) noexcept;
/// [N/m] The same without the client's damping.   4.47
double reduced_stiffness_undamped(const DeformableCoupling& coupling, double omega, double round_trip) noexcept;

}  // namespace tactus::sim
