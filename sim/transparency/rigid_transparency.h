// SPDX-License-Identifier: Apache-2.0
/// What delay does to the force of a client that pushes a rigid object simulated at the server, how much of it nobody feels, and which
/// stiffness hides the rest (thesis, section 4.2).
///
/// One axis, along which the user moves; several users push the same object. External forces and those of others count as in equation 4.13:
/// f_e > 0 acts against the motion (friction), f_s > 0 pushes along. (Equation 4.4 has f_e with the other sign.)
#pragma once

#include <complex>
#include <optional>

#include <tactus/base/geometry.h>

namespace tactus::sim {

enum class DelayModel { exact, pade };

/// Laplace transform of a delay at s = j omega.   in  delay [s] >= 0, omega [rad/s]   4.6
/// The first-order Pade approximation has the right magnitude at all frequencies, and the right phase below pade_limit().
std::complex<double> delay_factor(double omega, double delay, DelayModel model) noexcept;
/// [rad/s] 1/(3 delay); infinite without delay.   4.6
double pade_limit(double delay) noexcept;

/// A client at a rigid object that can move along one axis.   figures 4.3, 4.4
struct RigidCoupling {
  double mass = 0;              ///< [kg] m_o > 0
  double damping = 0;           ///< [N s/m] b_o >= 0 of the object
  double client_stiffness = 0;  ///< [N/m] k_c > 0
  double server_stiffness = 0;  ///< [N/m] k_s > 0
  double client_damping = 0;    ///< [N s/m] b_c
  double server_damping = 0;    ///< [N s/m] b_s
  double forward = 0;           ///< [s] T_f, from the client to the server
  double backward = 0;          ///< [s] T_b

  double round_trip() const noexcept { return forward + backward; }
};

/// Client force by the velocity of the device [N s/m], at s = j omega.   in  omega [rad/s] > 0   4.4; with Pade and without dampers 4.7
std::complex<double> force_by_velocity(const RigidCoupling& coupling, double omega, DelayModel model) noexcept;
/// Client force by a force on the object at the server, against the motion [1].   4.5; with Pade and without dampers 4.8
std::complex<double> force_by_resistance(const RigidCoupling& coupling, double omega, DelayModel model) noexcept;

/// Viscous damper that takes as much energy per step as a physics simulation that multiplies velocities by a factor.
/// in   mass [kg] > 0, factor 0..1, step [s] > 0      4.12
double damping_of_factor(double mass, double factor, double step) noexcept;

/// Everything moves with one velocity and nothing changes. Along the motion of the user.
struct SteadyPush {
  double velocity = 0;  ///< [m/s] of device and object
  double damping = 0;   ///< [N s/m] b_o
  double external = 0;  ///< [N] f_e, against the motion
  double others = 0;    ///< [N] f_s, sum of the other users, along it

  /// [N] at the server: what the user should feel.   4.15
  double server_force() const noexcept { return damping * velocity + external - others; }
};

/// [N] at the client.   in  round_trip [s]   4.13, 4.14
double client_force(const SteadyPush& push, double client_stiffness, double server_stiffness, double round_trip) noexcept;
/// [N] by which delay raises the client force, at equal stiffness.   4.17
double excess_force(double velocity, double stiffness, double round_trip) noexcept;
/// [s] Round trip at which the client force is a share `weber` above what it should be; none: nothing moves, any delay is hidden.
/// 4.18 to 4.20
std::optional<double> tolerable_delay(const SteadyPush& push, double stiffness, double weber) noexcept;
/// [s] Change of the round trip that raises or lowers the client force by a share `weber`; none: nothing moves.   4.21 to 4.23
std::optional<double> tolerable_change(const SteadyPush& push, double stiffness, double round_trip, double weber) noexcept;
/// [N/m] Client stiffness with which the client force is that of the server.   4.24 to 4.26
double reduced_stiffness(const SteadyPush& push, double stiffness, double round_trip) noexcept;

/// [N] Forces on the object, b_o v + f_e - f_s, along the motion of the device: < 0 acts against it; 0: the device does not move.
/// in   resistance [N] b_o v_o + f_e - f_s; device_velocity [m/s]     4.29
double resistive_force(const Vec3& resistance, const Vec3& device_velocity) noexcept;
/// 0: the face is parallel to the surface that holds the object, so that it cannot move; 1: it stands upright on it.
/// in   constraint, face  unit normals     4.27
double blending(const Vec3& constraint, const Vec3& face) noexcept;
/// [N/m] As above in three dimensions.   in  resistive [N] < 0, speed [m/s] of the device, beta 0..1   4.28, 4.30
double reduced_stiffness(double resistive, double speed, double stiffness, double round_trip, double beta) noexcept;
/// [s] none: nothing moves.   4.31
std::optional<double> tolerable_delay(double resistive, double speed, double stiffness, double weber) noexcept;
/// [s] none: nothing moves.   4.32
std::optional<double> tolerable_change(double resistive, double speed, double stiffness, double round_trip,
                                       double weber) noexcept;

}  // namespace tactus::sim
