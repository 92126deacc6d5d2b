// SPDX-License-Identifier: Apache-2.0
/// Cost of one step of the thesis's membrane by method, as soft as it is and 1000 times stiffer, both under 1 N; set-up of modal reduction
/// by number of modes; price of the Cholesky factor (and of CHOLMOD's in a build with TACTUS_WITH_CHOLMOD); conjugate gradients by size.
/// Counter z: displacement of the loaded vertex after 0.3 s [m].
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>

#include <tactus/sim/fem/cholesky.h>
#include <tactus/sim/fem/integrator.h>
#include <tactus/sim/fem/linear_solver.h>
#include "tests/unit/fem_fixture.h"

namespace tactus {
namespace {

constexpr double kStep = 1e-3;
constexpr int kRun = 300;

void five(benchmark::internal::Benchmark* b) { b->Unit(benchmark::kMicrosecond)->Repetitions(5)->ReportAggregatesOnly(); }

void step(benchmark::State& state, double young, const sim::IntegratorOptions& options) {
  sim::FemModel model = testing::slab_model(testing::slab_options(young));
  const Eigen::VectorXd f = testing::slab_load(model);
  auto integrator = std::move(sim::make_integrator(model, options).value());
  sim::FemState body = model.rest();
  for (int i = 0; i < kRun; ++i) {
    if (const auto report = integrator->step(f, body); !report) return state.SkipWithError(to_string(report.error()).c_str());
  }
  state.counters["z"] = body.u[3 * testing::kSlabCentre + 2];
  for (auto _ : state) benchmark::DoNotOptimize(integrator->step(f, body));
}

void set_up_modal(benchmark::State& state) {
  sim::FemModel model = testing::slab_model();
  sim::IntegratorOptions o;
  o.method = sim::Method::modal;
  o.modes = static_cast<int>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(sim::make_integrator(model, o));
}

/// A slab of `cells` x `cells` x 2 cubes as an implicit step at 1 kHz sees it.
struct Matrix {
  explicit Matrix(std::uint32_t cells)
      : model(testing::make_model(sim::make_slab(cells, cells, 2, 0.01),
                                  {.materials = {{1e4, 0.45, 1e4}}, .fixed = testing::slab_corners(cells, cells, 2)})),
        system(model) {
    system.assemble(Eigen::VectorXd::Zero(model.size()), 4 / (kStep * kStep), 1);
  }

  sim::FemModel model;
  sim::SystemMatrix system;
};

template <class Factor>
void factor(benchmark::State& state) {
  const Matrix m(static_cast<std::uint32_t>(state.range(0)));
  Factor cholesky;
  cholesky.analyse(m.system.matrix());
  for (auto _ : state) benchmark::DoNotOptimize(cholesky.factor(m.system.matrix()));
  state.counters["tets"] = static_cast<double>(m.model.mesh().tets.size());
  state.counters["fill"] = static_cast<double>(cholesky.fill());
}

template <class Factor>
void solve(benchmark::State& state) {
  const Matrix m(static_cast<std::uint32_t>(state.range(0)));
  Factor cholesky;
  cholesky.analyse(m.system.matrix());
  cholesky.factor(m.system.matrix());
  Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(m.system.matrix().rows(), -1, 1);
  const Eigen::VectorXd b = x;
  for (auto _ : state) cholesky.solve(b, x);
  state.counters["tets"] = static_cast<double>(m.model.mesh().tets.size());
}

void gradients(benchmark::State& state) {
  const Matrix m(static_cast<std::uint32_t>(state.range(0)));
  sim::ConjugateGradients solver(m.system.matrix().rows(), 1e-6);
  Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(m.system.matrix().rows(), -1, 1);
  const Eigen::VectorXd b = x;
  int iterations = 0;
  for (auto _ : state) {
    solver.prepare(m.system.matrix());
    x.setZero();
    iterations = solver.solve(m.system.matrix(), b, x);
  }
  const auto tets = static_cast<double>(m.model.mesh().tets.size());
  state.counters["tets"] = tets;
  state.counters["iterations"] = iterations;
  state.counters["per_tet"] =
      benchmark::Counter(tets, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void register_steps() {
  for (const double young : {1e4, 1e7}) {
    for (const sim::Method method : {sim::Method::velocity_verlet, sim::Method::backward_euler, sim::Method::newmark,
                                     sim::Method::tr_bdf2, sim::Method::modal, sim::Method::projective}) {
      for (const sim::LinearSolver solver :
           {sim::LinearSolver::conjugate_gradients, sim::LinearSolver::cholesky, sim::LinearSolver::prefactored}) {
        const bool implicit =
            method == sim::Method::backward_euler || method == sim::Method::newmark || method == sim::Method::tr_bdf2;
        if (!implicit && solver != sim::LinearSolver::conjugate_gradients) continue;
        sim::IntegratorOptions o;
        o.method = method;
        o.step = kStep;
        o.solver = solver;
        o.modes = 30;
        if (solver != sim::LinearSolver::prefactored && implicit) o.newton_iterations = 1;
        else o.newton_tolerance = 1e-2;
        const std::string label = std::string("step/") + name(method) + (implicit ? std::string("/") + name(solver) : "");
        five(benchmark::RegisterBenchmark((label + (young > 1e5 ? "/stiff" : "/soft")).c_str(), step, young, o));
      }
    }
  }
}

[[maybe_unused]] const bool registered = (register_steps(), true);

BENCHMARK(set_up_modal)->Apply(five)->Arg(10)->Arg(50)->Arg(200);
BENCHMARK(factor<sim::LdlCholesky>)->Apply(five)->Arg(13)->Arg(40)->Arg(91);
BENCHMARK(solve<sim::LdlCholesky>)->Apply(five)->Arg(13)->Arg(40)->Arg(91);
#ifdef TACTUS_FEM_CHOLMOD
BENCHMARK(factor<sim::CholmodCholesky>)->Apply(five)->Arg(13)->Arg(40)->Arg(91);
BENCHMARK(solve<sim::CholmodCholesky>)->Apply(five)->Arg(13)->Arg(40)->Arg(91);
#endif
BENCHMARK(gradients)->Apply(five)->Arg(13)->Arg(40)->Arg(129);

}  // namespace
}  // namespace tactus
