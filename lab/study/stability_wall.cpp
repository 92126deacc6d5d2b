// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <tactus/sim/user/hand.h>
#include "lab/study/stability.h"
#include "lab/study/wall.h"

namespace tactus::sim::study {
namespace {

constexpr double kHaptic = 1e-3, kVisual = 1.0 / 60;  // [s]
constexpr double kDeviceMass = 0.05;                  // [kg] of a desktop device at its handle
constexpr double kWidth = 1e-4;                       // relative, of a bisection
constexpr double kSoftest = 1e-2, kStiffest = 1e7;    // [N/m]

double passive_limit(double wall_damping, double device_damping, double period, Motion motion) {
  const auto holds = [&](double k) { return is_passive({k, wall_damping}, device_damping, period, motion); };
  return holds(kSoftest) ? bisect(kSoftest, kStiffest, kWidth, holds) : 0;
}

double stable_limit(double wall_damping, const Impedance& held, double period) {
  const auto holds = [&](double k) { return is_stable({k, wall_damping}, held, period); };
  return holds(kSoftest) ? bisect(kSoftest, kStiffest, kWidth, holds) : 0;
}

Impedance held(double device_damping, std::optional<Grip> grip) {
  Impedance out{.mass = kDeviceMass, .damping = device_damping};
  if (grip) {
    const HandImpedance hand = hand_impedance(*grip);
    out = {out.mass + hand.mass, out.damping + hand.damping, hand.stiffness};
  }
  return out;
}

std::vector<Parameter> parameters(double period, double device_damping, double wall_damping) {
  std::vector<Parameter> out{{"rate", 1 / period, "Hz"}, {"b_d", device_damping, "N s/m"}};
  if (wall_damping > 0) out.push_back({"b_o", wall_damping, "N s/m"});
  return out;
}

Row limit_row(const std::string& subject, std::vector<Parameter> parameters, double measured, double analytic) {
  Row row{.subject = subject, .parameters = std::move(parameters), .verdict = Verdict::limit};
  row.quantity = "largest k_o";
  row.unit = "N/m";
  row.measured = measured;
  row.analytic = analytic;
  return row;
}

/// Eqs. 2.3 and 2.4 by the passivity observer.
void passivity_rows(Study& study) {
  for (const double period : {kHaptic, kVisual})
    for (const double damping : {0.1, 0.35, 1.0, 5.0})
      study.rows.push_back(limit_row("passive, eq. 2.3", parameters(period, damping, 0),
                                     passive_limit(0, damping, period, Motion::slow), 2 * damping / period));
  for (const double damping : {0.1, 0.35, 1.0})
    study.rows.push_back(limit_row("passive for slow motion, eq. 2.4", parameters(kHaptic, 0.35, damping),
                                   passive_limit(damping, 0.35, kHaptic, Motion::slow), 2 * (0.35 + damping) / kHaptic));
  for (const double damping : {0.0, 0.1, 0.3}) {
    Row row = limit_row("passive at 500 Hz", parameters(kHaptic, 0.35, damping),
                        passive_limit(damping, 0.35, kHaptic, Motion::fast), 2 * (0.35 - damping) / kHaptic);
    if (damping > 0) row.remark = "a sampled damper gives energy away when motion is fast";
    study.rows.push_back(row);
  }
}

void stability_rows(Study& study) {
  struct Hand {
    const char* name;
    std::optional<Grip> grip;
  };
  for (const double period : {kHaptic, kVisual})
    for (const Hand& hand : {Hand{"device alone, stable", std::nullopt}, Hand{"loose grip, stable", Grip::loose},
                             Hand{"normal grip, stable", Grip::normal}, Hand{"firm grip, stable", Grip::firm}}) {
      const Impedance impedance = held(0.35, hand.grip);
      study.rows.push_back(limit_row(hand.name, parameters(period, 0.35, 0), stable_limit(0, impedance, period),
                                     largest_spring(transition(impedance, period))));
    }
}

/// Limits over the damping of the device, for eq. 2.3.
Series over_device_damping(const std::string& name, double period) {
  Series out{.name = name, .columns = {"b_d [N s/m]", "eq. 2.3 [N/m]", "observer [N/m]", "device alone stable [N/m]"}};
  for (int i = 0; i < 16; ++i) {
    const double damping = 0.05 * std::pow(2, 0.5 * i);
    out.rows.push_back({damping, 2 * damping / period, passive_limit(0, damping, period, Motion::slow),
                        stable_limit(0, held(damping, std::nullopt), period)});
  }
  return out;
}

/// The Z-width: which (K, B) a wall may have.
Series z_width(const Progress& progress) {
  Series out{
      .name = "z-width",
      .columns = {"B [N s/m]", "slow motion [N/m]", "fast motion [N/m]", "device alone stable [N/m]", "loose grip stable [N/m]"}};
  constexpr int kFine = 7, kPoints = 38;  // closer together while the fast motion can be passive
  for (int i = 0; i < kPoints; ++i) {
    progress("wall, Z-width", static_cast<std::uint64_t>(i), kPoints);
    const double damping = i < kFine ? 0.05 * i : 0.25 * (i - kFine + 2);
    out.rows.push_back(
        {damping, passive_limit(damping, 0.35, kHaptic, Motion::slow), passive_limit(damping, 0.35, kHaptic, Motion::fast),
         stable_limit(damping, held(0.35, std::nullopt), kHaptic), stable_limit(damping, held(0.35, Grip::loose), kHaptic)});
  }
  return out;
}

}  // namespace

Study study_wall(Extent extent, const Progress& progress) {
  Study study{.name = "wall", .title = "Sampled virtual wall"};
  study.text =
      "A spring of stiffness k_o and a damper b_o, computed once per sample from the device's position and held (thesis 2.2.2). "
      "*Passive*: a hand that yields to nothing drives the device (damping b_d) into the wall and out again, and the passivity "
      "observer of `sim/user/passivity.h` shows whether more energy came out than went in. Theory is eq. 2.3, b_d > k_o T / 2, "
      "eq. 2.4, b_d + b_o > k_o T / 2, for slow motion, and b_d > k_o T / 2 + b_o (Colgate and Schenkel) for every motion. "
      "*Stable*: device (50 g) and hand, solved exactly between samples, are tied to the wall, displaced and let go. Theory is "
      "Jury's criterion on the exactly discretised loop. With a grip, much stiffer walls are stable than passivity allows, "
      "because the hand's damping counts.";
  progress("wall", 0, 2);
  passivity_rows(study);
  progress("wall", 1, 2);
  stability_rows(study);
  if (extent == Extent::brief) return study;
  study.series.push_back(over_device_damping("damping-1khz", kHaptic));
  study.series.push_back(over_device_damping("damping-60hz", kVisual));
  study.series.push_back(z_width(progress));
  return study;
}

}  // namespace tactus::sim::study
