// SPDX-License-Identifier: Apache-2.0
// Starts, impulses and inputs that no sane scene has: integrators recover or stop with an error; what is not a number never gets out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <tactus/sim/fem/integrator.h>
#include <tactus/sim/random.h>
#include "tests/unit/fem_fixture.h"

namespace tactus::sim {
namespace {

using Eigen::VectorXd;

std::vector<IntegratorOptions> usual_integrators(double step) {
  std::vector<IntegratorOptions> out;
  for (const Method method :
       {Method::velocity_verlet, Method::backward_euler, Method::newmark, Method::tr_bdf2, Method::modal, Method::projective}) {
    IntegratorOptions o;
    o.method = method;
    o.step = step;
    o.modes = 12;
    out.push_back(o);
    if (method != Method::backward_euler && method != Method::newmark && method != Method::tr_bdf2) continue;
    o.solver = LinearSolver::cholesky;
    o.newton_iterations = 1;
    out.push_back(o);
    o.solver = LinearSolver::prefactored;
    o.newton_iterations = 10;
    o.newton_tolerance = 1e-2;
    out.push_back(o);
  }
  return out;
}

std::string label(const IntegratorOptions& o) {
  return std::string(name(o.method)) + " " + name(o.solver) + " " + std::to_string(o.newton_iterations);
}

FemModel damped(double young = 1e4, double poisson = 0.45) {
  FemOptions options;
  options.materials = {{young, poisson, 1e4}};
  options.fixed = testing::slab_corners(4, 3);
  options.mass_damping = 5;
  options.stiffness_damping = 1e-3;
  return testing::make_model(make_slab(4, 3, 1, 0.01), options);
}

enum class Start { mirrored, plane, line, point, random };

/// Displacements that put the free vertices there.
FemState start_at(const FemModel& model, Start start) {
  FemState state = model.rest();
  Random random(11);
  for (std::uint32_t i = 0; i < model.mesh().vertices.size(); ++i) {
    if (model.is_fixed(i)) continue;
    const Vec3& x = model.mesh().vertices[i];
    const Vec3 centre{0.02, 0.015, 0.005};
    Vec3 to = x;
    switch (start) {
      case Start::mirrored:
        to.z = 0.01 - x.z;
        break;
      case Start::plane:
        to.z = centre.z;
        break;
      case Start::line:
        to = {x.x, centre.y, centre.z};
        break;
      case Start::point:
        to = centre;
        break;
      case Start::random:
        to = {random.uniform(0, 0.04), random.uniform(0, 0.03), random.uniform(0, 0.01)};
        break;
    }
    state.u.segment<3>(3 * static_cast<Eigen::Index>(i)) = Eigen::Vector3d(to.x - x.x, to.y - x.y, to.z - x.z);
  }
  return state;
}

int inverted(const FemModel& model, const VectorXd& u) {
  TetMesh moved = model.mesh();
  for (std::size_t i = 0; i < moved.vertices.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    moved.vertices[i] = moved.vertices[i] + Vec3{u[at], u[at + 1], u[at + 2]};
  }
  int count = 0;
  for (std::size_t t = 0; t < moved.tets.size(); ++t) count += volume(moved, t) <= 0 ? 1 : 0;
  return count;
}

/// Steps until the end or an error, which must be R-FEM-6 with everything said and the state as it was.
/// ret  whether the end was reached
bool survives(FemModel& model, const IntegratorOptions& options, FemState& state, int steps) {
  const auto integrator = std::move(make_integrator(model, options).value());
  const VectorXd f = VectorXd::Zero(model.size());
  for (int i = 0; i < steps; ++i) {
    const FemState before = state;
    const auto report = integrator->step(f, state);
    EXPECT_TRUE(state.u.allFinite() && state.v.allFinite()) << "step " << i;
    if (report) continue;
    EXPECT_STREQ(report.error().error.rule, "R-FEM-6");
    EXPECT_EQ(report.error().step, i);
    EXPECT_STREQ(report.error().kind, "tetrahedron");
    EXPECT_NE(report.error().remedy.find("ms"), std::string::npos) << report.error().remedy;
    EXPECT_TRUE(state.u == before.u && state.v == before.v);
    return false;
  }
  return true;
}

TEST(FemExtreme, CollapsedAndMirroredStartsRecover) {
  for (const Start start : {Start::mirrored, Start::plane, Start::line, Start::point, Start::random}) {
    for (const IntegratorOptions& o : usual_integrators(1e-3)) {
      if (o.method == Method::modal) continue;  // linear
      SCOPED_TRACE(label(o) + ", start " + std::to_string(static_cast<int>(start)));
      FemModel model = damped();
      FemState state = start_at(model, start);
      EXPECT_TRUE(survives(model, o, state, 1500));
      EXPECT_EQ(inverted(model, state.u), 0);
    }
  }
}

// Where the choice is implicit, energy would grow a million times within 40 steps without the steps of backward Euler between. Velocity
// Verlet keeps the energy, which swings below the limit of stability.
TEST(FemExtreme, AnUndampedJumbleGainsNoEnergyWithWhatChooseTakes) {
  for (const double young : {1e7, 1e8, 1e10}) {
    SCOPED_TRACE(young);
    FemOptions options = testing::slab_options(young);
    options.fixed = testing::slab_corners(4, 5);
    FemModel model = testing::make_model(make_slab(4, 5, 1, 0.01), options);
    FemState state = model.rest();
    Random random(3);
    for (const int i : model.free_dofs()) state.u[i] = random.uniform(-0.002, 0.002);
    const double start = model.energy(state.u);
    const Choice choice = choose(model, 1e-3);
    EXPECT_TRUE(survives(model, choice.options, state, 1000));
    const double end = model.energy(state.u) + 0.5 * state.v.cwiseAbs2().dot(model.lumped_mass());
    EXPECT_LT(end, (choice.options.method == Method::velocity_verlet ? 2 : 1e-2) * start) << choice.reason;
  }
}

// 1000 times stiffer, nearly incompressible: what damps must come back, nobody may answer with a NaN.
TEST(FemExtreme, StiffObjectsRecoverWithWhatChooseTakes) {
  for (const auto& [young, poisson] : {std::pair{1e7, 0.45}, {1e4, 0.499}, {1e10, 0.3}}) {
    for (const Start start : {Start::mirrored, Start::plane, Start::line, Start::point, Start::random}) {
      SCOPED_TRACE(std::to_string(young) + " nu " + std::to_string(poisson) + ", start " +
                   std::to_string(static_cast<int>(start)));
      FemModel model = damped(young, poisson);
      const Choice choice = choose(model, 1e-3);
      EXPECT_TRUE(choice.options.method == Method::tr_bdf2 || choice.options.substeps > 1) << choice.reason;
      FemState state = start_at(model, start);
      EXPECT_TRUE(survives(model, choice.options, state, 1000));
      EXPECT_EQ(inverted(model, state.u), 0);
    }
  }
}

TEST(FemExtreme, ImpulsesEndWellOrWithAnError) {
  for (const double speed : {10.0, 1000.0}) {
    for (const double young : {1e4, 1e7}) {
      for (const IntegratorOptions& o : usual_integrators(1e-3)) {
        SCOPED_TRACE(label(o) + ", " + std::to_string(speed) + " m/s, E " + std::to_string(young));
        FemModel model = damped(young);
        FemState state = model.rest();
        for (const int i : model.free_dofs()) state.v[i] = i % 3 == 2 ? speed : 0;
        const bool alive = survives(model, o, state, 500);
        const bool stable = o.method == Method::modal || (o.method == Method::backward_euler && o.newton_iterations > 1);
        if (speed == 10 && (stable || (young == 1e4 && o.method == Method::velocity_verlet))) {
          EXPECT_TRUE(alive);
        }
      }
    }
  }
}

TEST(FemExtreme, ExplicitBeyondItsLimitStopsWithTheStepTheElementAndAStepThatWorks) {
  FemModel model = testing::slab_model(testing::slab_options(1e7));
  IntegratorOptions o;
  auto integrator = std::move(make_integrator(model, o).value());
  FemState state = model.rest();
  const VectorXd f = testing::slab_load(model);
  Diagnostic error;
  for (int i = 0; i < 100 && error.remedy.empty(); ++i)
    if (auto report = integrator->step(f, state); !report) error = report.error();
  EXPECT_STREQ(error.error.rule, "R-FEM-6");
  EXPECT_GE(error.step, 1);
  EXPECT_STREQ(error.kind, "tetrahedron");
  EXPECT_NE(error.remedy.find("stable up to omega = 2000 rad/s, this object has 18"), std::string::npos) << error.remedy;
  const auto at = error.remedy.find("below ");
  ASSERT_NE(at, std::string::npos);
  o.step = 1e-3 * std::stod(error.remedy.substr(at + 6));
  integrator = std::move(make_integrator(model, o).value());
  state = model.rest();
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(integrator->step(f, state));
}

// Slightly beyond the limit of stability: one mode grows a little with every step.
TEST(FemExtreme, EnergyFromNowhereIsADivergence) {
  FemModel model = damped();
  IntegratorOptions o;
  o.step = 2.02 / model.largest_frequency();
  FemModel undamped = testing::make_model(model.mesh(), [&] {
    FemOptions options = model.options();
    options.mass_damping = options.stiffness_damping = 0;
    return options;
  }());
  FemState state = undamped.rest();
  Random random(3);
  for (const int i : undamped.free_dofs()) state.v[i] = random.uniform(-1e-3, 1e-3);
  EXPECT_FALSE(survives(undamped, o, state, 100000));
}

TEST(FemExtreme, WhatIsNotANumberIsRefusedAndChangesNothing) {
  for (const IntegratorOptions& o : usual_integrators(1e-3)) {
    SCOPED_TRACE(label(o));
    FemModel model = damped();
    const auto integrator = std::move(make_integrator(model, o).value());
    FemState state = model.rest();
    VectorXd f = VectorXd::Zero(model.size());
    f[50] = 0.1;
    ASSERT_TRUE(integrator->step(f, state));
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      for (int which = 0; which < 4; ++which) {
        FemState broken = state;
        VectorXd force = f;
        if (which == 0) force[7] = bad;
        if (which == 1) broken.u[7] = bad;
        if (which == 2) broken.v[7] = bad;
        if (which == 3) force.resize(3);
        const FemState before = broken;
        const auto report = integrator->step(force, broken);
        ASSERT_FALSE(report);
        EXPECT_STREQ(report.error().error.rule, "R-FEM-5");
        EXPECT_EQ(report.error().error.code, Errc::invalid_argument);
        EXPECT_TRUE(std::equal(broken.u.begin(), broken.u.end(), before.u.begin(),
                               [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }));
      }
    }
    const FemState before = state;
    f.setConstant(1e300);
    const auto report = integrator->step(f, state);
    ASSERT_FALSE(report);
    EXPECT_STREQ(report.error().error.rule, "R-FEM-6");
    EXPECT_TRUE(state.u == before.u && state.v == before.v);
    f.setZero();
    EXPECT_TRUE(integrator->step(f, state)) << "goes on afterwards";
  }
}

TEST(FemExtreme, EverythingFixedNothingFixedAndTwoParts) {
  for (const int kind : {0, 1, 2}) {
    TetMesh mesh = make_slab(2, 2, 1, 0.01);
    FemOptions options;
    options.materials = {{1e4, 0.3, 1000}};
    const auto count = static_cast<std::uint32_t>(mesh.vertices.size());
    if (kind == 0)
      for (std::uint32_t i = 0; i < count; ++i) options.fixed.push_back(i);
    if (kind == 2) {
      for (std::uint32_t i = 0; i < count; ++i) mesh.vertices.push_back(mesh.vertices[i] + Vec3{1, 0, 0});
      for (std::size_t i = 0, n = mesh.tets.size(); i < n; ++i) {
        Tet tet = mesh.tets[i];
        for (std::uint32_t& v : tet) v += count;
        mesh.tets.push_back(tet);
      }
    }
    FemModel model = testing::make_model(mesh, options);
    for (const IntegratorOptions& o : usual_integrators(2e-4)) {
      SCOPED_TRACE(label(o) + ", kind " + std::to_string(kind));
      auto made = make_integrator(model, o);
      if (kind == 0 && o.method == Method::modal) {
        ASSERT_FALSE(made);
        EXPECT_STREQ(made.error().error.rule, "R-FEM-8");
        continue;
      }
      ASSERT_TRUE(made);
      FemState state = model.rest();
      VectorXd f = VectorXd::Zero(model.size());
      f[2] = 1e-3;
      for (int i = 0; i < 100; ++i) ASSERT_TRUE((*made)->step(f, state));
      EXPECT_EQ(state.u.norm() > 0, kind != 0);
      if (kind == 2) {
        EXPECT_LT(state.u.tail(3 * count).norm(), 1e-6 * state.u.norm()) << "the other part feels nothing";
      }
    }
  }
}

TEST(FemExtreme, OptionsThatNoMethodCanMeetAreRefused) {
  FemModel model = damped();
  const auto refused = [&](auto&& change) {
    IntegratorOptions o;
    change(o);
    const auto made = make_integrator(model, o);
    return !made && std::string(made.error().error.rule) == "R-FEM-8" && !made.error().remedy.empty();
  };
  EXPECT_TRUE(refused([](auto& o) { o.step = 0; }));
  EXPECT_TRUE(refused([](auto& o) { o.step = std::nan(""); }));
  EXPECT_TRUE(refused([](auto& o) { o.step = 2; }));
  EXPECT_TRUE(refused([](auto& o) { o.solver_tolerance = 0; }));
  EXPECT_TRUE(refused([](auto& o) { o.newton_tolerance = 1; }));
  EXPECT_TRUE(refused([](auto& o) { o.newton_iterations = 0; }));
  EXPECT_TRUE(refused([](auto& o) { o.substeps = 0; }));
  EXPECT_TRUE(refused([](auto& o) { o.method = Method::modal; }));
  EXPECT_TRUE(refused([](auto& o) { o.method = Method::modal, o.modes = 100000; }));
}

TEST(FemExtreme, TheQuasiNewtonSchemeIsRefusedWhereItDoesNotConverge) {
  for (const double poisson : {0.4999, 0.49999}) {
    FemOptions options = testing::slab_options(1e4, poisson);
    options.fixed = testing::slab_corners(4, 4);
    options.mass_damping = 5;
    FemModel model = testing::make_model(make_slab(4, 4, 1, 0.01), options);
    IntegratorOptions quasi;
    quasi.solver = LinearSolver::prefactored;
    for (const Method method : {Method::backward_euler, Method::newmark, Method::tr_bdf2, Method::projective}) {
      quasi.method = method;
      const auto made = make_integrator(model, quasi);
      EXPECT_EQ(made.has_value(), poisson == 0.4999) << name(method);
      if (made) continue;
      EXPECT_STREQ(made.error().error.rule, "R-FEM-8");
      EXPECT_NE(made.error().remedy.find("cholesky"), std::string::npos) << made.error().remedy;
    }
    FemState state = model.rest();
    Random random(3);
    for (const int i : model.free_dofs()) state.u[i] = random.uniform(-0.002, 0.002);
    const double start = model.energy(state.u);
    const IntegratorOptions chosen = suited(model, Method::tr_bdf2, 1e-3);
    EXPECT_EQ(chosen.solver, poisson == 0.4999 ? LinearSolver::prefactored : LinearSolver::cholesky);
    EXPECT_TRUE(survives(model, chosen, state, 300));
    EXPECT_LT(model.energy(state.u), 1e-2 * start);
  }
}

TEST(Choose, TakesTheCheapestThatIsStableAndSaysWhy) {
  const auto chosen = [](double young, double beta, Elasticity elasticity = Elasticity::corotated) {
    FemOptions options = testing::slab_options(young);
    options.stiffness_damping = beta;
    options.elasticity = elasticity;
    const FemModel model = testing::slab_model(options);
    return choose(model, 1e-3);
  };
  const Choice soft = chosen(1e4, 0);
  EXPECT_EQ(soft.options.method, Method::velocity_verlet);
  EXPECT_EQ(soft.options.substeps, 1);
  EXPECT_NEAR(soft.largest_frequency, 578, 1);
  EXPECT_NE(soft.reason.find("h omega = 0.578"), std::string::npos) << soft.reason;
  const Choice damped = chosen(1e4, 0.01);
  EXPECT_GT(damped.options.substeps, 1) << "stiffness damping limits explicit steps: " << damped.reason;
  const Choice stiffer = chosen(1e7, 0);
  EXPECT_EQ(stiffer.options.method, Method::velocity_verlet);
  EXPECT_EQ(stiffer.options.substeps, 11);
  EXPECT_NE(stiffer.reason.find("omega 1.828e+04"), std::string::npos) << stiffer.reason;
  EXPECT_NE(stiffer.reason.find("11 sub-steps"), std::string::npos) << stiffer.reason;
  const Choice stiff = chosen(1e8, 0);
  EXPECT_EQ(stiff.options.method, Method::tr_bdf2);
  EXPECT_EQ(stiff.options.solver, LinearSolver::prefactored);
  EXPECT_NE(stiff.reason.find("33 sub-steps"), std::string::npos) << stiff.reason;
  EXPECT_EQ(chosen(1e8, 0, Elasticity::linear).options.solver, LinearSolver::cholesky);
}

}  // namespace
}  // namespace tactus::sim
