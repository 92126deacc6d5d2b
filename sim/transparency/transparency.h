// SPDX-License-Identifier: Apache-2.0
/// What a delay costs: stiffness as displayed beside the true one, of rigid and deformable objects.
#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/client/stiffness_reduction.h>
#include <tactus/sim/msd/msd.h>

namespace tactus::sim {

// ==== pressing ====
// Users press a one-dimensional deformable object through a network that delays: what they feel, with and without a client that makes
// up for the delay. Thesis figures 4.18, 4.21 and 4.24.

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
struct PressForces {
  std::vector<double> client;  ///< [N] rendered to the hand
  std::vector<double> server;  ///< [N] rendered at the server from what arrived there
};

/// err  invalid_argument R-API-4: a delay is longer than StiffnessReduction::kMostDelay, lambda
/// time O(users * duration)
Result<std::vector<PressForces>> press(const Pressing& pressing);

// ==== rigid transparency ====
// What delay does to the force of a client that pushes a rigid object simulated at the server, how much of it nobody feels, and which
// stiffness hides the rest (thesis, section 4.2).
//
// One axis, along which the user moves; several users push the same object. External forces and those of others count as in equation 4.13:
// f_e > 0 acts against the motion (friction), f_s > 0 pushes along. (Equation 4.4 has f_e with the other sign.)

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
/// [s] Round trip at which the client force is a fraction `weber` above what it should be; none: nothing moves, any delay is hidden.
/// 4.18 to 4.20
std::optional<double> tolerable_delay(const SteadyPush& push, double stiffness, double weber) noexcept;
/// [s] Change of the round trip that raises or lowers the client force by a fraction `weber`; none: nothing moves.   4.21 to 4.23
std::optional<double> tolerable_change(const SteadyPush& push, double stiffness, double round_trip, double weber) noexcept;
/// [N/m] Client stiffness with which the client force is that of the server.   4.24 to 4.26
double reduced_stiffness(const SteadyPush& push, double stiffness, double round_trip) noexcept;

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

// ==== deformable transparency ====
// What delay does to the impedance that a client renders of a deformable object simulated at the server, how much of it nobody feels,
// and which stiffness hides the rest (thesis, section 4.3). One axis; the object is a damped spring with a mass.

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

/// [s] Round trip at which the client's impedance is a fraction `weber` above the server's, both with K_i and with k_c = k_s; none: it is so
/// at every delay (the client's damping alone does it), or at none.
/// in   omega [rad/s] > 0      4.45
std::optional<double> tolerable_delay(const DeformableCoupling& coupling, double omega, double weber) noexcept;

/// [N/m] Client stiffness with which the client's impedance has the magnitude of the server's, both with K_i; never below zero.
/// in   omega [rad/s] > 0, round_trip [s] < pi/omega      4.46
double reduced_stiffness(const DeformableCoupling& coupling, double omega, double round_trip) noexcept;
/// [N/m] The same without the client's damping.   4.47
double reduced_stiffness_undamped(const DeformableCoupling& coupling, double omega, double round_trip) noexcept;

}  // namespace tactus::sim
