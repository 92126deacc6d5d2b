// SPDX-License-Identifier: Apache-2.0
/// Cost of finite elements: one step of the membrane, forces by instruction set and by size, assembly, rotations; and the same
/// membrane in Bullet (double precision) when that is there. Counters:
///   z           displacement of the loaded vertex after 0.3 s [m]; velocity Verlet with exact rotations gives -0.058422 at this step
///   over_ours   Bullet's time per step over ours, both in CPU time and in this run
///   over_limit  time of the forces over what their operations take at the machine's peak (peak.h), measured in this run
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <tactus/sim/fem/element.h>
#include <tactus/sim/random.h>
#include "tests/bench/peak.h"
#include "tests/unit/fem_fixture.h"
#ifdef TACTUS_BENCH_BULLET
#include "tests/bench/bullet_slab.h"
#endif

namespace tactus {
namespace {

constexpr double kStep = 1e-3;
constexpr int kRun = 300;  // steps of one loaded motion, 0.3 s

/// Additions, multiplications, divisions and comparisons of a tetrahedron's forces where its rotation is found at the first attempt:
///   57 F, 32 matrix of the start, 45 M, 96 equation of the rotation, 38 its root, 63 new rotation and matrix, 45 R^T F, 21 strain and
///   stress, 45 P, 54 forces, 12 sums
constexpr double kFlops = 508;
/// Linear: 57 F, 21 strain and stress, 54 forces, 12 sums
constexpr double kLinearFlops = 144;

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void five(benchmark::internal::Benchmark* b) { b->Unit(benchmark::kMicrosecond)->Repetitions(5)->ReportAggregatesOnly(); }

/// The loaded membrane's motion from rest, again and again.
template <class Start, class Step, class Deflection>
void repeat(benchmark::State& state, Start start, Step step, Deflection z) {
  start();
  for (int i = 0; i < kRun; ++i) step();
  state.counters["z"] = z();
  int i = kRun;
  for (auto _ : state) {
    if (i++ == kRun) {
      state.PauseTiming();
      start();
      i = 1;
      state.ResumeTiming();
    }
    step();
  }
}

void membrane(benchmark::State& state, sim::Elasticity elasticity) {
  sim::FemOptions options = testing::slab_options();
  options.elasticity = elasticity;
  sim::FemModel model = testing::slab_model(options);
  testing::ExplicitRun run(model, kStep, testing::slab_load(model));
  repeat(
      state, [&] { run.state = model.rest(); }, [&] { run.step(); }, [&] { return run.state.u[3 * testing::kSlabCentre + 2]; });
}
BENCHMARK_CAPTURE(membrane, corotated, sim::Elasticity::corotated)->Apply(five);
BENCHMARK_CAPTURE(membrane, linear, sim::Elasticity::linear)->Apply(five);

#ifdef TACTUS_BENCH_BULLET
/// CPU time of a step, mean over the loaded motion, the best of five [s].
template <class Start, class Step>
double mean_step(Start start, Step step) {
  double shortest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5; ++i) {
    start();
    const double begin = cpu_seconds();
    for (int k = 0; k < kRun; ++k) step();
    shortest = std::min(shortest, (cpu_seconds() - begin) / kRun);
  }
  return shortest;
}

void membrane_bullet(benchmark::State& state) {
  sim::FemModel model = testing::slab_model();
  std::unique_ptr<testing::BulletSlab> slab;
  const auto start = [&] { slab = std::make_unique<testing::BulletSlab>(model, testing::slab_options().materials[0]); };
  const auto step = [&] { slab->step(kStep, testing::kSlabCentre, -1); };
  repeat(state, start, step, [&] { return slab->z(testing::kSlabCentre); });
  testing::ExplicitRun ours(model, kStep, testing::slab_load(model));
  state.counters["over_ours"] = mean_step(start, step) / mean_step([&] { ours.state = model.rest(); }, [&] { ours.step(); });
}
BENCHMARK(membrane_bullet)->Apply(five);
#endif

/// A slab bent over a cylinder and shaken, in frames that are a millisecond apart at 10 rad/s.
struct Motion {
  explicit Motion(std::uint32_t layers, std::uint32_t nx = testing::kSlabX, std::uint32_t ny = testing::kSlabY)
      : mesh(sim::make_slab(nx, ny, layers, 0.01)) {
    sim::Random random(1);
    std::vector<double> noise(3 * mesh.vertices.size());
    for (double& x : noise) x = random.uniform(-5e-4, 5e-4);
    for (int i = 0; i < 8; ++i) {
      const double bend = 0.5 + 0.01 * std::abs(i - 4);
      std::vector<double> u;
      for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const Vec3& x = mesh.vertices[v];
        const double angle = bend * x.x / (0.01 * nx), r = 0.01 * nx / bend + x.z;
        u.insert(u.end(), {r * std::sin(angle) - x.x + noise[3 * v], noise[3 * v + 1],
                           r * std::cos(angle) - 0.01 * nx / bend - x.z + noise[3 * v + 2]});
      }
      frames.push_back(std::move(u));
    }
  }

  sim::TetMesh mesh;
  std::vector<std::vector<double>> frames;
};

void evaluate(benchmark::State& state, const Motion& motion, sim::InstructionSet set, bool corotated) {
  if (!supported(set)) return state.SkipWithError("not on this machine");
  sim::Elements elements(motion.mesh, std::vector<sim::Lame>(motion.mesh.tets.size(), {3448, 31034}), corotated);
  elements.use(set);
  std::vector<double> k(3 * motion.mesh.vertices.size());
  std::size_t i = 0;
  const double begin = cpu_seconds();
  for (auto _ : state) {
    elements.forces(motion.frames[i++ % motion.frames.size()].data(), k.data());
    benchmark::DoNotOptimize(k.data());
    benchmark::ClobberMemory();
  }
  const double seconds = (cpu_seconds() - begin) / static_cast<double>(state.iterations());
  const auto tets = static_cast<double>(motion.mesh.tets.size());
  state.counters["s/tet"] = seconds / tets;
  state.counters["over_limit"] = seconds / (tets * (corotated ? kFlops : kLinearFlops) / testing::peak(set));
}

void forces(benchmark::State& state, sim::InstructionSet set, bool corotated) { evaluate(state, Motion(1), set, corotated); }
BENCHMARK_CAPTURE(forces, portable, sim::InstructionSet::portable, true)->Apply(five);
BENCHMARK_CAPTURE(forces, avx2, sim::InstructionSet::avx2, true)->Apply(five);
BENCHMARK_CAPTURE(forces, avx512, sim::InstructionSet::avx512, true)->Apply(five);
BENCHMARK_CAPTURE(forces, portable_linear, sim::InstructionSet::portable, false)->Apply(five);
BENCHMARK_CAPTURE(forces, avx2_linear, sim::InstructionSet::avx2, false)->Apply(five);
BENCHMARK_CAPTURE(forces, avx512_linear, sim::InstructionSet::avx512, false)->Apply(five);

/// 1 920, 19 200, 201 600 tetrahedra.
void forces_by_size(benchmark::State& state) {
  const auto scale = static_cast<std::uint32_t>(state.range(0));
  const Motion motion(scale == 1 ? 1 : scale == 2 ? 10 : 21, scale < 3 ? 16 : 40, scale < 3 ? 20 : 40);
  state.SetLabel(std::to_string(motion.mesh.tets.size()) + " tets");
  evaluate(state, motion, sim::widest(), true);
}
BENCHMARK(forces_by_size)->Arg(1)->Arg(2)->Arg(3)->Apply(five);

/// Collapsed to a line, where every element needs the robust rotation: the worst case.
void forces_on_a_line(benchmark::State& state) {
  Motion motion(1);
  for (std::vector<double>& u : motion.frames) {
    for (std::size_t v = 0; v < motion.mesh.vertices.size(); ++v) {
      u[3 * v + 1] = -motion.mesh.vertices[v].y;
      u[3 * v + 2] = -motion.mesh.vertices[v].z;
    }
  }
  evaluate(state, motion, sim::widest(), true);
}
BENCHMARK(forces_on_a_line)->Apply(five);

void matrix(benchmark::State& state, void (sim::FemModel::*assemble)(const Eigen::VectorXd&, sim::SparseMatrix&)) {
  sim::FemModel model = testing::slab_model();
  const Motion motion(1);
  const Eigen::VectorXd u = Eigen::Map<const Eigen::VectorXd>(motion.frames[0].data(), model.size());
  sim::SparseMatrix K;
  (model.*assemble)(u, K);
  for (auto _ : state) (model.*assemble)(u, K);
}
BENCHMARK_CAPTURE(matrix, stiffness, &sim::FemModel::stiffness)->Apply(five);
BENCHMARK_CAPTURE(matrix, tangent, &sim::FemModel::tangent)->Apply(five);

void largest_frequency(benchmark::State& state) {
  const sim::FemModel model = testing::slab_model();
  for (auto _ : state) benchmark::DoNotOptimize(model.largest_frequency());
}
BENCHMARK(largest_frequency)->Apply(five);

void robust_rotation(benchmark::State& state) {
  sim::Random random(1);
  std::vector<sim::Matrix3> matrices(1024);
  for (sim::Matrix3& f : matrices)
    for (auto& row : f.m)
      for (double& x : row) x = random.uniform(-1, 1);
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(sim::nearest_rotation(matrices[i++ % matrices.size()], {}));
}
BENCHMARK(robust_rotation)->Unit(benchmark::kNanosecond)->Repetitions(5)->ReportAggregatesOnly();

}  // namespace
}  // namespace tactus
