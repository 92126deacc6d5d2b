// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include <tactus/sim/msd/msd.h>
#include <tactus/sim/user/hand.h>
#include <tactus/sim/user/passivity.h>
#include "lab/study/sampled_mass.h"
#include "lab/study/stability.h"

namespace tactus::sim::study {
namespace {

constexpr double kTick = 1e-3;  // [s] T_s
constexpr std::uint32_t kDivider = 10;
constexpr double kDuration = 4;   // [s]
constexpr double kOnset = 0.3;    // [s] in which the hand builds up its force
constexpr double kPress = 1;      // [N]
constexpr double kStart = -2e-3;  // [m] outside the object
constexpr double kLimit = 40;     // [N] no device renders more: beyond it the interaction has diverged
// "The human impedance is nearly zero" (thesis 4.3.2.1): the stylus lies on the fingers, its inertia and some skin take part.
constexpr Impedance kBarelyHeld{.mass = 0.05, .damping = 0.8, .stiffness = 5};

struct Setting {
  const char* panel;
  const char* subject;
  const char* remark;
  Impedance hand;
  double object_stiffness = 350;  // k_o [N/m]
  double client_damping = 0;      // b_c [N s/m]
  std::uint32_t delay = 100;      // [ticks] both ways together
};

Impedance of(Grip grip) {
  const HandImpedance hand = hand_impedance(grip);
  return {hand.mass, hand.damping, hand.stiffness};
}

MsdLoopOptions loop_of(const Setting& setting) {
  MsdLoopOptions out{.object = {.stiffness = setting.object_stiffness, .damping = 1, .mass = 0.01},
                     .tick = kTick,
                     .divider = kDivider,
                     .client = Approach::linear,
                     .coupling = Coupling::pressing,
                     .users = {}};
  out.users.push_back({.server_stiffness = 250,
                       .client_stiffness = 700,
                       .client_damping = setting.client_damping,
                       .to_server = setting.delay / 2,
                       .from_server = setting.delay - setting.delay / 2});
  return out;
}

struct Outcome {
  Verdict verdict = Verdict::stable;
  double lowest_energy = 0;  // [J]
  Series series;
};

/// The hand lets its force on the object grow to kPress and holds it.
Outcome interact(const Setting& setting) {
  const MsdLoopOptions options = loop_of(setting);
  MsdLoop loop(options);
  // Where the device comes to rest when the client's spring holds kPress.
  const MsdUser& user = options.users[0];
  const double yield = user.server_stiffness / (user.server_stiffness + setting.object_stiffness);
  const double rest = kPress / (user.client_stiffness * (1 - yield));
  SampledMass hand(setting.hand, kTick);
  hand.move_to(kStart, 0);
  PassivityObserver port;
  Outcome out{.series = {.name = setting.panel, .columns = {"t [s]", "f [N]", "E [mJ]"}}};
  double early = 0, late = 0, last = 0;  // speeds
  for (int tick = 0; tick * kTick < kDuration; ++tick) {
    const double time = tick * kTick, x = hand.position();
    port.arrive({x, 0, 0});
    loop.step(std::array{x});
    const double rendered = loop.rendered_force(0);
    port.hold({rendered, 0, 0});
    if (tick % 2 == 0) out.series.rows.push_back({time, -rendered, 1e3 * port.energy()});
    if (-rendered > kLimit) {
      out.verdict = Verdict::diverges;
      break;
    }
    const double done = minimum_jerk(std::min(1.0, time / kOnset)).position;
    hand.step(rendered + done * kPress + setting.hand.stiffness * (kStart + done * (rest - kStart)));
    const double speed = std::abs(hand.velocity());
    if (time > 1 && time < 2) early = std::max(early, speed);
    if (time > 3) late = std::max(late, speed);
    last = speed;
  }
  out.lowest_energy = port.lowest();
  if (out.verdict == Verdict::stable && late > 0.5 * early && last > 1e-6) out.verdict = Verdict::limit;
  return out;
}

bool comes_to_rest(const Setting& setting) { return interact(setting).verdict == Verdict::stable; }

/// Limits for a barely held device that presses to come to rest: the longest delay, and the least damping at the client for 100 ms.
void limit_rows(Study& study, const Progress& progress) {
  Setting setting{"", "barely held", "", kBarelyHeld, 350, 0, 0};
  const auto add = [&](const char* quantity, const char* unit, double measured, const char* remark) {
    Row row{.subject = "barely held, limit", .verdict = Verdict::limit, .quantity = quantity, .unit = unit};
    row.parameters = {{"k_o", setting.object_stiffness, "N/m"}, {"b_c", setting.client_damping, "N s/m"}};
    row.measured = measured;
    row.remark = remark;
    study.rows.push_back(std::move(row));
  };
  for (const double damping : {0.0, 1.0}) {
    progress("client, limits", damping > 0 ? 1 : 0, 3);
    setting.client_damping = damping;
    const auto holds = [&](double delay) {
      setting.delay = static_cast<std::uint32_t>(std::lround(delay));
      return comes_to_rest(setting);
    };
    if (!holds(1) || holds(400)) continue;
    add("longest delay", "ms", bisect(1, 400, 0.01, holds), "both ways together, to a tick");
  }
  progress("client, limits", 2, 3);
  setting.delay = 100;
  const auto holds = [&](double inverse) {
    setting.client_damping = 1 / inverse;
    return comes_to_rest(setting);
  };
  if (!holds(0.1) || holds(100)) return;
  const double least = 1 / bisect(0.1, 100, 0.01, holds);
  setting.client_damping = least;
  add("least b_c", "N s/m", least, "for a delay of 100 ms");
}

}  // namespace

Study study_client(Extent, const Progress& progress) {
  Study study{.name = "client", .title = "Force rendering at a client with delay"};
  study.text =
      "Thesis figure 4.17: a user presses a mass-spring-damper object over a network, k_c = 700 N/m, k_s = 250 N/m, N = 10, m_o "
      "= 10 g and b_o = 1 N s/m (the thesis does not state these three); the hand builds up 1 N. What the thesis calls a loose "
      "grasp has nearly no impedance. Here it is a stylus lying on the fingers: 50 g, 0.8 N s/m, 5 N/m. The loose grip of "
      "sim/user (12 N s/m) is far from that and stable throughout. The passivity observer watches the port between hand and "
      "client.";
  const std::array<Setting, 6> settings{
      {{"a", "barely held", "", kBarelyHeld, 350, 0, 0},
       {"b", "barely held", "bounces on and on, and gives energy away", kBarelyHeld},
       {"c", "barely held, damped by the client", "", kBarelyHeld, 350, 5},
       {"d", "normal grip", "", of(Grip::normal)},
       {"e", "barely held, stiffer object", "slightly active and stable, as the thesis finds", kBarelyHeld, 1000},
       {"f", "loose grip of sim/user", "", of(Grip::loose)}}};
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const Setting& setting = settings[i];
    progress("client", i, settings.size());
    Outcome outcome = interact(setting);
    Row row{.subject = std::string("(") + setting.panel + ") " + setting.subject, .verdict = outcome.verdict};
    row.parameters = {{"delay", static_cast<double>(setting.delay), "ms"},
                      {"k_o", setting.object_stiffness, "N/m"},
                      {"b_c", setting.client_damping, "N s/m"}};
    row.quantity = "lowest energy";
    row.unit = "mJ";
    row.measured = 1e3 * outcome.lowest_energy;
    row.remark = setting.remark;
    study.rows.push_back(std::move(row));
    study.series.push_back(std::move(outcome.series));
  }
  limit_rows(study, progress);
  return study;
}

}  // namespace tactus::sim::study
