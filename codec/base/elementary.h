// SPDX-License-Identifier: Apache-2.0
/// Elementary functions that give the same bits everywhere: those of C libraries differ in their last bits, and so would traces and
/// packets made with them. Only + - * / and sqrt in a written order, and powers of two. Errors of at most 3 units in the last place,
/// of power() 3 + |y log x|.   time 5 to 20 ns; no allocation
#pragma once

namespace tactus {

inline constexpr double kPi = 3.14159265358979323846;

/// in  x  [rad] at most 1e6 in size, where the error is below 1e-15; beyond it grows
double sine(double x) noexcept;
double cosine(double x) noexcept;
/// Angle of (x, y) in [-pi, pi] rad; 0 for (0, 0).
double angle_of(double y, double x) noexcept;
double arc_sine(double x) noexcept;              ///< pre  |x| <= 1
double arc_cosine(double x) noexcept;            ///< likewise
double exponential(double x) noexcept;           ///< e^x
double exponential_less_one(double x) noexcept;  ///< e^x - 1
double logarithm(double x) noexcept;             ///< natural; of 0 minus infinity.   pre  x >= 0, finite
double power(double x, double y) noexcept;       ///< x^y.   pre  x >= 0, finite

}  // namespace tactus
