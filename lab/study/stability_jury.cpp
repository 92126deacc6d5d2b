// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "lab/study/server_loop.h"
#include "lab/study/stability.h"

namespace tactus::sim::study {
namespace {

// Thesis figure 4.16.
constexpr ServerLoop kFigure{.object = {.stiffness = 100, .damping = 1, .mass = 0.01}, .users = 2};
constexpr double kPress = 1e-3;       // [m] step of each user
constexpr double kSecondUser = 0.32;  // [s] when the second one begins to press
constexpr double kFigureEnd = 0.8;    // [s]
constexpr double kAround = 20;        // [N/m] above and below the critical sum

// A vertex of the thesis's membrane alone: 3.2 kg / 714, neither spring nor damper.
constexpr MsdObject kSlabVertex{.stiffness = 0, .damping = 0, .mass = 3.2 / 714};

struct Setting {
  std::string subject;
  ServerLoop loop;
};

/// Settings that differ from the figure in one parameter.
std::vector<Setting> variations() {
  std::vector<Setting> out;
  const auto vary = [&](const std::string& subject, auto change) {
    ServerLoop loop = kFigure;
    change(loop);
    out.push_back({subject, loop});
  };
  for (const std::uint32_t users : {1u, 2u, 4u}) vary("number of users", [&](ServerLoop& l) { l.users = users; });
  for (const std::uint32_t n : {1u, 2u, 5u, 17u, 33u}) vary("deformation rate", [&](ServerLoop& l) { l.divider = n; });
  for (const double k : {0.0, 10.0, 1e3, 1e4}) vary("object stiffness", [&](ServerLoop& l) { l.object.stiffness = k; });
  for (const double b : {0.0, 0.1, 10.0}) vary("object damping", [&](ServerLoop& l) { l.object.damping = b; });
  for (const double m : {1e-4, 1e-3, 0.1, 1.0}) vary("object mass", [&](ServerLoop& l) { l.object.mass = m; });
  for (const std::uint32_t n : {1u, 17u}) out.push_back({"vertex of the slab, alone", {.object = kSlabVertex, .divider = n}});
  vary("last force, not the mean", [](ServerLoop& l) { l.decimator = Decimator::last; });
  vary("surface approached linearly", [](ServerLoop& l) { l.approach = Approach::linear; });
  return out;
}

std::vector<ServerLoop> grid() {
  std::vector<ServerLoop> out;
  for (const std::uint32_t users : {1u, 2u})
    for (const std::uint32_t divider : {1u, 2u, 5u, 10u, 17u})
      for (const double stiffness : {0.0, 100.0, 1000.0})
        for (const double damping : {0.0, 1.0, 10.0})
          for (const double mass : {1e-3, 1e-2, 0.1, 1.0})
            out.push_back({.object = {stiffness, damping, mass}, .divider = divider, .users = users});
  return out;
}

Row limit_row(const Setting& setting) {
  const ServerLoop& loop = setting.loop;
  Row row{.subject = setting.subject, .quantity = "sum of k_s", .unit = "N/m"};
  row.parameters = {{"N", static_cast<double>(loop.divider), ""},
                    {"users", static_cast<double>(loop.users), ""},
                    {"k_o", loop.object.stiffness, "N/m"},
                    {"b_o", loop.object.damping, "N s/m"},
                    {"m_o", loop.object.mass, "kg"}};
  const double limit = measured_limit(loop);
  row.verdict = Verdict::limit;
  row.measured = limit * loop.users;
  row.analytic = jury_limit(loop) * loop.users;
  const bool confirmed = spectral_radius(loop, 0.99 * limit) < 1 + 1e-9 && spectral_radius(loop, 1.01 * limit) > 1;
  row.remark = confirmed ? "" : "the poles do not cross the unit circle here";
  return row;
}

/// Every setting of the grid: one row for all of them, the points for a plot.
void measure_grid(Study& study, const Progress& progress) {
  const std::vector<ServerLoop> loops = grid();
  Series points{.name = "grid", .columns = {"formula [N/m]", "measured [N/m]"}};
  double worst = 0;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    progress("jury, grid", i, loops.size());
    const double users = loops[i].users, analytic = jury_limit(loops[i]) * users, measured = measured_limit(loops[i]) * users;
    worst = std::max(worst, std::abs(measured / analytic - 1));
    points.rows.push_back({analytic, measured});
  }
  Row row{.subject = "grid of " + std::to_string(loops.size()) + " settings", .verdict = Verdict::limit};
  row.quantity = "largest deviation";
  row.unit = "%";
  row.measured = 100 * worst;
  row.remark = "N 1..17, k_o 0..1000 N/m, b_o 0..10 N s/m, m_o 1 g..1 kg, one and two users";
  study.rows.push_back(row);
  study.series.push_back(std::move(points));
}

/// The limit over N: formula and measured.
Series over_divider(const std::string& name, ServerLoop loop) {
  Series out{.name = name, .columns = {"N", "formula [N/m]", "measured [N/m]"}};
  for (const std::uint32_t n : {1u, 2u, 3u, 5u, 7u, 10u, 14u, 20u, 30u, 50u}) {
    loop.divider = n;
    out.rows.push_back({static_cast<double>(n), jury_limit(loop) * loop.users, measured_limit(loop) * loop.users});
  }
  return out;
}

Series figure_response(const std::string& name, double sum_of_stiffness) {
  MsdLoop loop(kFigure.options(sum_of_stiffness / kFigure.users));
  Series out{.name = name, .columns = {"t [s]", "x_o [mm]"}};
  std::array<double, 2> device{kPress, kAway};
  for (int tick = 0; tick * kFigure.tick < kFigureEnd; ++tick) {
    const double time = tick * kFigure.tick;
    if (time >= kSecondUser) device[1] = kPress;
    loop.step(device);
    out.rows.push_back({time, 1e3 * loop.surface()});
  }
  return out;
}

Row figure_row(double sum_of_stiffness) {
  Row row{.subject = "figure 4.16", .quantity = "pole radius", .remark = "700 N/m is the limit"};
  row.parameters = {{"sum of k_s", sum_of_stiffness, "N/m"}};
  row.verdict = step_response(kFigure, sum_of_stiffness / kFigure.users);
  row.measured = spectral_radius(kFigure, sum_of_stiffness / kFigure.users);
  return row;
}

}  // namespace

Study study_jury(Extent extent, const Progress& progress) {
  Study study{.name = "jury", .title = "Deformation loop at the server"};
  study.text =
      "Users press a mass-spring-damper object that is deformed every N ticks of 1 ms. Every hand steps 1 mm into it. The "
      "largest stiffness with a response that stays bounded over 20 000 deformation periods is found by bisection and compared "
      "with Jury's criterion (thesis eqs. 4.37 and 4.38). The poles of the closed loop (eq. 4.36) must leave the unit circle at "
      "the same stiffness.";
  const double critical = critical_stiffness(kFigure.object, kFigure.period());
  for (const double around : {kAround, -kAround}) study.rows.push_back(figure_row(critical + around));
  study.series.push_back(figure_response("figure-4.16-a", critical + kAround));
  study.series.push_back(figure_response("figure-4.16-b", critical - kAround));
  const std::vector<Setting> settings = variations();
  for (std::size_t i = 0; i < settings.size(); ++i) {
    progress("jury", i, settings.size());
    study.rows.push_back(limit_row(settings[i]));
  }
  if (extent == Extent::brief) return study;
  measure_grid(study, progress);
  ServerLoop linear = kFigure, heavy = kFigure;
  linear.approach = Approach::linear;
  heavy.object = {.stiffness = 1000, .damping = 10, .mass = 0.1};
  study.series.push_back(over_divider("over-n-figure", kFigure));
  study.series.push_back(over_divider("over-n-linear", linear));
  study.series.push_back(over_divider("over-n-heavy", heavy));
  study.series.push_back(over_divider("over-n-vertex", {.object = kSlabVertex}));
  return study;
}

}  // namespace tactus::sim::study
