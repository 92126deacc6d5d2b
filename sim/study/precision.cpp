// SPDX-License-Identifier: Apache-2.0
#include "sim/study/precision.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <numbers>

namespace tactus::study {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double square(double x) { return x * x; }

/// Where in a step [0, 1] external forces are taken.
double force_point(Method method) {
  switch (method) {
    case Method::backward_euler:
    case Method::projective:
      return 1;
    case Method::velocity_verlet:
    case Method::newmark:
    case Method::tr_bdf2:
    case Method::modal:
      return 0.5;
  }
  return 0;
}

double probe_force(const PrecisionScene& scene, double deflection, double t) {
  const double path = -scene.probe.depth * square(std::sin(std::numbers::pi * t / (2 * scene.duration)));
  return -scene.probe.stiffness * std::max(0.0, deflection - path);
}

double external_force(const PrecisionScene& scene, Loading loading, double deflection, double t) {
  if (loading == Loading::probe) return probe_force(scene, deflection, t);
  return -scene.load * square(std::sin(2 * std::numbers::pi * t));
}

tl::expected<FemModel, FemError> make_model(const PrecisionScene& scene, const PrecisionMethod& method) {
  FemOptions options;
  options.materials = {scene.material};
  options.fixed = scene.fixed;
  options.elasticity = method.elasticity;
  return FemModel::create(scene.mesh, std::move(options));
}

double total_energy(FemModel& model, const FemState& state) {
  return model.energy(state.u) + 0.5 * state.v.dot(model.lumped_mass().cwiseProduct(state.v));
}

/// A simulation under way.
struct Run {
  const PrecisionScene& scene;
  const PrecisionMethod& method;
  Loading loading;
  FemModel model, observer;  // the integrator has its model for itself
  std::unique_ptr<Integrator> integrator;
  FemState state;
  Eigen::VectorXd f;
  Trajectory out;

  tl::expected<void, FemError> step(std::int64_t number);
  void sample(int number);
};

tl::expected<void, FemError> Run::step(std::int64_t number) {
  const double h = method.options.step, point = force_point(method.options.method);
  const double t = (static_cast<double>(number) + point) * h;
  const double deflection = scene.patch.deflection(state.u) + point * h * scene.patch.deflection(state.v);
  f.setZero();
  scene.patch.add_force(external_force(scene, loading, deflection, t), f);
  const auto report = integrator->step(f, state);
  if (!report) return tl::unexpected(report.error());
  out.newton_per_step += report->newton_iterations;
  out.solver_per_step += report->solver_iterations;
  if (!report->converged) ++out.unconverged_steps;
  return {};
}

void Run::sample(int number) {
  const double t = scene.duration * (number + 1) / scene.samples;
  const double deflection = scene.patch.deflection(state.u);
  out.u.push_back(state.u);
  out.energy[number] = total_energy(observer, state);
  out.force[number] = probe_force(scene, deflection, t);
}

tl::expected<Run, FemError> start(const PrecisionScene& scene, const PrecisionMethod& method, Loading loading) {
  auto model = make_model(scene, method);
  if (!model) return tl::unexpected(model.error());
  auto observer = make_model(scene, method);
  if (!observer) return tl::unexpected(observer.error());
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model->size());
  Run run{scene, method, loading, *std::move(model), *std::move(observer), nullptr, {zero, zero}, zero, {}};
  run.out.energy.resize(scene.samples);
  run.out.force.resize(scene.samples);
  return run;
}

double relative(double difference, double size) { return size > 0 ? difference / size : kNaN; }

double displacement_error(const Trajectory& a, const Trajectory& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < b.u.size(); ++i) {
    difference += (a.u[i] - b.u[i]).squaredNorm();
    size += b.u[i].squaredNorm();
  }
  return relative(std::sqrt(difference), std::sqrt(size));
}

Errors difference(const Trajectory& load, const Trajectory& reference) {
  Errors out;
  out.displacement_end = relative((load.u.back() - reference.u.back()).norm(), reference.u.back().norm());
  out.displacement = displacement_error(load, reference);
  out.energy = relative((load.energy - reference.energy).norm(), reference.energy.norm());
  out.force = kNaN;
  return out;
}

double force_error(const Trajectory& probe, const Trajectory& reference) {
  return relative((probe.force - reference.force).norm(), reference.force.norm());
}

double median(const std::vector<Trajectory>& runs, double Trajectory::*quantity) {
  std::vector<double> values;
  values.reserve(runs.size());
  for (const Trajectory& run : runs) values.push_back(run.*quantity);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

double processor_seconds() noexcept {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

tl::expected<Trajectory, FemError> simulate(const PrecisionScene& scene, const PrecisionMethod& method, int steps_per_sample,
                                            Loading loading) {
  PrecisionMethod with_step = method;
  with_step.options.step = scene.step(steps_per_sample);
  auto run = start(scene, with_step, loading);
  if (!run) return tl::unexpected(run.error());
  const double begin = processor_seconds();
  auto integrator = make_integrator(run->model, with_step.options);
  if (!integrator) return tl::unexpected(integrator.error());
  run->integrator = *std::move(integrator);

  double since = begin;
  const std::int64_t steps = std::int64_t{steps_per_sample} * scene.samples;
  for (std::int64_t i = 0; i < steps; ++i) {
    if (const auto done = run->step(i); !done) return tl::unexpected(done.error());
    if (i > 0 && (i + 1) % steps_per_sample != 0) continue;
    const double now = processor_seconds();
    (i == 0 ? run->out.setup_seconds : run->out.step_seconds) += now - since;
    if ((i + 1) % steps_per_sample == 0) run->sample(static_cast<int>(i / steps_per_sample));
    since = processor_seconds();
  }
  const auto count = static_cast<double>(steps);
  run->out.step_seconds *= count / (count - 1);
  run->out.newton_per_step /= count;
  run->out.solver_per_step /= count;
  return std::move(run->out);
}

tl::expected<Reference, FemError> make_reference(const PrecisionScene& scene) {
  const PrecisionMethod method{"reference", {.method = Method::velocity_verlet}};
  const int n = scene.reference_steps_per_sample;
  Reference out;
  out.step = scene.step(n);
  std::vector<Trajectory> coarse;  // load at n/2, probe at n/2, load at n/4
  for (const auto& [steps, loading] :
       {std::pair{n, Loading::force}, std::pair{n, Loading::probe}, std::pair{n / 2, Loading::force},
        std::pair{n / 2, Loading::probe}, std::pair{n / 4, Loading::force}}) {
    auto trajectory = simulate(scene, method, steps, loading);
    if (!trajectory) return tl::unexpected(trajectory.error());
    if (steps < n) coarse.push_back(*std::move(trajectory));
    else (loading == Loading::force ? out.load : out.probe) = *std::move(trajectory);
  }
  out.floor = difference(coarse[0], out.load);
  out.floor.force = force_error(coarse[1], out.probe);
  out.order = std::log2(displacement_error(coarse[2], coarse[0]) / out.floor.displacement);
  for (double* error : {&out.floor.displacement_end, &out.floor.displacement, &out.floor.force, &out.floor.energy})
    *error /= 3;  // of two results of order 2, the finer one is off by a third of their difference
  return out;
}

PrecisionPoint measure(const PrecisionScene& scene, const PrecisionMethod& method, int steps_per_sample,
                       const Reference& reference, const Timing& timing) {
  PrecisionPoint out;
  out.method = method.name;
  out.steps_per_sample = steps_per_sample;
  out.step = scene.step(steps_per_sample);
  auto run = simulate(scene, method, steps_per_sample, Loading::force);
  if (!run) {
    out.errors = {kNaN, kNaN, kNaN, kNaN};
    out.remark = to_string(run.error());
    return out;
  }
  out.errors = difference(*run, reference.load);
  out.newton_per_step = run->newton_per_step;
  out.solver_per_step = run->solver_per_step;
  out.unconverged_steps = run->unconverged_steps;
  const auto probe = simulate(scene, method, steps_per_sample, Loading::probe);
  if (probe) out.errors.force = force_error(*probe, reference.probe);
  else out.remark = "probe: " + to_string(probe.error());

  std::vector<Trajectory> runs;
  const bool once = run->setup_seconds + run->step_seconds > timing.longest_repeated;
  if (once) runs.push_back(*std::move(run));
  while (!once && static_cast<int>(runs.size()) < timing.runs) {
    auto again = simulate(scene, method, steps_per_sample, Loading::force);
    if (!again) return out;  // never: it is the first run once more
    runs.push_back(*std::move(again));
  }
  out.runs = static_cast<int>(runs.size());
  out.seconds_per_second = median(runs, &Trajectory::step_seconds) / scene.duration;
  out.setup_seconds = median(runs, &Trajectory::setup_seconds);
  return out;
}

}  // namespace tactus::study
