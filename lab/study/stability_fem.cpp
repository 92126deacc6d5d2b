// SPDX-License-Identifier: Apache-2.0
#include "lab/study/stability_fem.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "lab/study/fem_cases.h"

namespace tactus::sim::study {
namespace {

constexpr std::array kMethods{Method::velocity_verlet, Method::backward_euler, Method::newmark,
                              Method::tr_bdf2,         Method::projective,     Method::modal};

constexpr double kGravity = 9.81;  // [m/s^2]
constexpr double kSettling = 200;  // [1/s] mass damping that ends every swing within seconds
constexpr double kCreep = 1e-9;    // of the sag: more than rounding and the solvers' tolerance explain

std::string cell_text(const FemOutcome& outcome) {
  if (outcome.refused) return "refused";
  if (outcome.verdict == Verdict::limit) return std::to_string(outcome.inverted) + " inverted";
  if (outcome.verdict == Verdict::diverges && !outcome.error.empty()) return "stopped, step " + std::to_string(outcome.steps);
  return name(outcome.verdict);
}

/// Includes the energy at the end: a stable method can still damp the motion.
std::string chosen_text(const FemOutcome& outcome) {
  std::string out = outcome.taken.empty() ? cell_text(outcome) : outcome.taken + ": " + cell_text(outcome);
  if (!outcome.error.empty()) return out;
  std::array<char, 32> kept{};
  std::snprintf(kept.data(), kept.size(), ", energy x%.2g", outcome.energy);
  return out + kept.data();
}

Row outcome_row(const FemCase& fem_case, const std::string& method, const FemOutcome& outcome) {
  Row row{.subject = fem_case.name + ", " + method, .verdict = outcome.verdict, .detail = true};
  row.parameters = {{"h", fem_case.step, "s"}, {"steps", static_cast<double>(fem_case.steps), ""}};
  row.quantity = "energy kept";
  if (outcome.error.empty()) row.measured = outcome.energy;
  row.remark = outcome.error.empty() ? outcome.taken : outcome.error;
  return row;
}

struct Totals {
  int runs = 0, stopped = 0, grown = 0, explained = 0, located = 0, kept = 0;
  std::size_t not_finite = 0;

  void add(Method method, const FemOutcome& outcome) {
    ++runs;
    not_finite += outcome.not_finite;
    const bool has_error = !outcome.error.empty();
    // What the modal method conserves is the energy of the linear problem, for which half a turn is an enormous strain.
    grown += outcome.verdict == Verdict::diverges && !has_error && method != Method::modal ? 1 : 0;
    if (!has_error || outcome.refused) return;
    ++stopped;
    explained += outcome.error.find("step") != std::string::npos && !outcome.error.ends_with(": ") ? 1 : 0;
    located += outcome.error.find("tetrahedron") != std::string::npos ? 1 : 0;
    kept += outcome.kept_state ? 1 : 0;
  }
};

void total_rows(Study& study, const Totals& totals) {
  const auto add = [&](const std::string& quantity, double measured, double wanted, const std::string& remark) {
    Row row{.subject = "all runs", .verdict = measured == wanted ? Verdict::stable : Verdict::diverges, .quantity = quantity};
    row.parameters = {{"runs", static_cast<double>(totals.runs), ""}};
    row.measured = measured;
    row.analytic = wanted;
    row.remark = remark;
    study.rows.push_back(row);
  };
  add("states with NaN or infinity", static_cast<double>(totals.not_finite), 0, "that left a step");
  add("energy grew unnoticed", totals.grown, 0, "tenfold without an error; modal runs, which are linear, not counted");
  add("stopped with a remedy", totals.explained, totals.stopped, "and the number of the step");
  add("stopped with the old state", totals.kept, totals.stopped, "bit by bit");
  add("stopped at an element", totals.located, totals.stopped, "torn, or stretched most when energy stopped it");
}

void extremes(Study& study, Extent extent, const Progress& progress) {
  const std::vector<FemCase> cases = fem_cases(extent);
  study.matrix.corner = "extreme";
  for (const Method method : kMethods) study.matrix.columns.emplace_back(name(method));
  study.matrix.columns.emplace_back("chosen");
  Totals totals;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    progress("fem, extremes", i, cases.size());
    auto& [label, cells] = study.matrix.rows.emplace_back(cases[i].name, std::vector<std::string>{});
    for (const Method method : kMethods) {
      const FemOutcome outcome = run(cases[i], method);
      totals.add(method, outcome);
      cells.push_back(cell_text(outcome));
      study.rows.push_back(outcome_row(cases[i], name(method), outcome));
    }
    const FemOutcome chosen = run(cases[i], std::nullopt);
    totals.add(Method::velocity_verlet, chosen);
    cells.push_back(chosen_text(chosen));
    study.rows.push_back(outcome_row(cases[i], "chosen", chosen));
  }
  total_rows(study, totals);
}

/// At rest under its own weight for many steps: nothing may creep.
void rest_rows(Study& study, Extent extent, const Progress& progress) {
  for (const Method method : kMethods) {
    progress("fem, at rest", static_cast<std::uint64_t>(method), kMethods.size());
    FemCase rest = shaken_slab(Extent::brief, {.density = 10'000}, 0);
    rest.options.mass_damping = kSettling;
    rest.gravity = kGravity;
    rest.steps = extent == Extent::brief ? 10'000 : 10'000'000;
    const FemOutcome outcome = run(rest, method);
    Row row{.subject = std::string("at rest under its weight, ") + name(method)};
    row.parameters = {{"steps", static_cast<double>(rest.steps), ""}, {"sag", outcome.farthest, "m"}};
    row.quantity = "drift over the second half";
    row.unit = "m";
    row.measured = outcome.drift;
    row.verdict = outcome.error.empty() && outcome.drift <= kCreep * outcome.farthest ? Verdict::stable : Verdict::diverges;
    row.remark = outcome.error;
    study.rows.push_back(row);
  }
}

double critical_step(const FemCase& fem_case) {
  const auto model = FemModel::create(fem_case.mesh, fem_case.options);
  return model ? 2 / model->largest_frequency() : 0;
}

void limit_rows(Study& study, Extent extent, const Progress& progress) {
  std::vector<Material> materials{{.young = 1e4, .poisson = 0.45, .density = 10'000},
                                  {.young = 1e6, .poisson = 0.3, .density = 10'000}};
  if (extent == Extent::full) {
    for (const double nu : {0.0, 0.49, 0.499, 0.4999}) materials.push_back({.young = 1e4, .poisson = nu, .density = 10'000});
    for (const double young : {1e2, 1e8, 1e10}) materials.push_back({.young = young, .poisson = 0.45, .density = 10'000});
  }
  for (std::size_t i = 0; i < materials.size(); ++i) {
    progress("fem, explicit limit", i, materials.size());
    const FemCase shaken = shaken_slab(extent, materials[i], 1e-7);
    Row row{.subject = "largest explicit step", .verdict = Verdict::limit, .quantity = "h", .unit = "ms"};
    row.parameters = {{"E", materials[i].young, "Pa"}, {"nu", materials[i].poisson, ""}};
    row.measured = 1e3 * largest_explicit_step(shaken);
    row.analytic = 1e3 * critical_step(shaken);
    row.remark = "2 / omega_max";
    study.rows.push_back(row);
  }
}

/// The (E, h) that each method gets through: 1000 steps of a slab displaced by up to 2 mm, without damping.
void map_series(Study& study, const Progress& progress) {
  Series limit{.name = "map-limit", .columns = {"E [Pa]", "h [s]"}};
  for (std::size_t m = 0; m + 1 < kMethods.size(); ++m) {
    Series map{.name = std::string("map-") + name(kMethods[m]), .columns = {"E [Pa]", "h [s]", "0 stable, 1 limit, 2 diverges"}};
    for (int e = 4; e <= 20; ++e) {
      progress("fem, map", m * 17 + static_cast<std::size_t>(e - 4), 17 * (kMethods.size() - 1));
      const double young = std::pow(10, e / 2.0);
      FemCase shaken = shaken_slab(Extent::brief, {.young = young, .poisson = 0.45, .density = 10'000}, 2e-3);
      shaken.steps = 1000;
      if (m == 0) limit.rows.push_back({young, critical_step(shaken)});
      for (int t = -12; t <= -2; ++t) {
        shaken.step = std::pow(10, t / 2.0);
        map.rows.push_back({young, shaken.step, static_cast<double>(run(shaken, kMethods[m]).verdict)});
      }
    }
    study.series.push_back(std::move(map));
  }
  study.series.push_back(std::move(limit));
}

}  // namespace

Study study_fem(Extent extent, const Progress& progress) {
  Study study{.name = "fem", .title = "Deformable objects"};
  study.text =
      "A co-rotated slab with fixed corners (4 x 5 x 1 cells of 1 cm, E 10 kPa, nu 0.45, 10 000 kg/m3, mass damping 20/s, h = 1 "
      "ms, 1000 steps unless said otherwise; the short form has 2 x 2 x 1 cells and 200 steps) starts in an extreme state and "
      "is left alone. *Stable*: all steps were done, the energy did not grow, and no tetrahedron is inside out. *N inverted*: "
      "the same, but N tetrahedra stay inside out. *Stopped*: a step was refused with an error that names step, tetrahedron and "
      "remedy (in stability.csv), and the state before it was kept. *Refused*: the run was not begun. The modal method keeps 12 "
      "modes of the linear problem and loses motion outside of them. Each method runs with the solver and the tolerance of a "
      "scene that names the method; *chosen* is the method of a scene that names none, with the energy at the end as a fraction "
      "of "
      "that at the start. The two slabs that turn freely are undamped: 1 is right. Newmark keeps the energy of a linear object, "
      "but not of one whose elements turn: in the map it has a stripe of stops at h omega_max of some 4 to 16. With longer "
      "steps its stages can no longer be solved; backward Euler takes over and damps. The explicit limit is bisected from tiny "
      "random displacements.";
  extremes(study, extent, progress);
  limit_rows(study, extent, progress);
  rest_rows(study, extent, progress);
  if (extent == Extent::full) map_series(study, progress);
  return study;
}

}  // namespace tactus::sim::study
