// SPDX-License-Identifier: Apache-2.0
#include "lab/study/precision.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <numbers>

namespace tactus::sim::study {
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

/// External forces at time t with the patch at `deflection`.
void external_forces(const PrecisionScene& scene, const FemModel& model, Loading loading, double deflection, double t,
                     Eigen::VectorXd& f) {
  f.setZero();
  switch (loading) {
    case Loading::force:
      return scene.patch.add_force(-scene.load * square(std::sin(2 * std::numbers::pi * t)), f);
    case Loading::probe:
      return scene.patch.add_force(probe_force(scene, deflection, t), f);
    case Loading::weight:
      for (Eigen::Index z = 2; z < f.size(); z += 3) f[z] = -scene.load * model.lumped_mass()[z] / model.total_mass();
      return;
    case Loading::push:
      return scene.patch.add_force(-scene.load, f);
  }
}

tl::expected<FemModel, Diagnostic> make_model(const PrecisionScene& scene, const PrecisionMethod& method) {
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
  FemModel model, observer;  // the integrator needs a model of its own
  std::unique_ptr<Integrator> integrator;
  FemState state;
  Eigen::VectorXd f;
  Trajectory out;

  tl::expected<void, Diagnostic> step(std::int64_t number);
  void sample(int number);
};

tl::expected<void, Diagnostic> Run::step(std::int64_t number) {
  const double h = method.options.step, point = force_point(method.options.method);
  const double t = (static_cast<double>(number) + point) * h;
  const double deflection = scene.patch.deflection(state.u) + point * h * scene.patch.deflection(state.v);
  external_forces(scene, model, loading, deflection, t, f);
  TACTUS_TRY(const auto report, integrator->step(f, state));
  out.newton_per_step += report.newton_iterations;
  out.solver_per_step += report.solver_iterations;
  if (!report.converged) ++out.unconverged_steps;
  return {};
}

void Run::sample(int number) {
  const double t = scene.duration * (number + 1) / scene.samples;
  const double deflection = scene.patch.deflection(state.u);
  out.u.push_back(state.u);
  out.v.push_back(state.v);
  out.energy[number] = total_energy(observer, state);
  out.force[number] = probe_force(scene, deflection, t);
}

tl::expected<Run, Diagnostic> start(const PrecisionScene& scene, const PrecisionMethod& method, Loading loading) {
  TACTUS_TRY(auto model, make_model(scene, method));
  TACTUS_TRY(auto observer, make_model(scene, method));
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.size());
  Run run{scene, method, loading, std::move(model), std::move(observer), nullptr, {zero, zero}, zero, {}};
  run.out.energy.resize(scene.samples);
  run.out.force.resize(scene.samples);
  return run;
}

double relative(double difference, double size) { return size > 0 ? difference / size : kNaN; }

using States = std::vector<Eigen::VectorXd>;

double state_error(const States& a, const States& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    difference += (a[i] - b[i]).squaredNorm();
    size += b[i].squaredNorm();
  }
  return relative(std::sqrt(difference), std::sqrt(size));
}

Errors difference(const Trajectory& load, const Trajectory& reference) {
  Errors out{kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};
  out.displacement_end = relative((load.u.back() - reference.u.back()).norm(), reference.u.back().norm());
  out.displacement = state_error(load.u, reference.u);
  out.velocity = state_error(load.v, reference.v);
  out.energy = relative((load.energy - reference.energy).norm(), reference.energy.norm());
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

tl::expected<Trajectory, Diagnostic> simulate(const PrecisionScene& scene, const PrecisionMethod& method, int steps_per_sample,
                                              Loading loading) {
  PrecisionMethod with_step = method;
  with_step.options.step = scene.step(steps_per_sample);
  TACTUS_TRY(auto run, start(scene, with_step, loading));
  const double begin = processor_seconds();
  if (method.chosen) {
    with_step.options = choose(run.model, with_step.options.step).options;
    run.out.taken = to_string(with_step.options);
  }
  TACTUS_TRY(auto integrator, make_integrator(run.model, with_step.options));
  run.integrator = std::move(integrator);

  double since = begin;
  const std::int64_t steps = std::int64_t{steps_per_sample} * scene.samples;
  for (std::int64_t i = 0; i < steps; ++i) {
    TACTUS_CHECK(run.step(i));
    if (i > 0 && (i + 1) % steps_per_sample != 0) continue;
    const double now = processor_seconds();
    (i == 0 ? run.out.setup_seconds : run.out.step_seconds) += now - since;
    if ((i + 1) % steps_per_sample == 0) run.sample(static_cast<int>(i / steps_per_sample));
    since = processor_seconds();
  }
  const auto count = static_cast<double>(steps);
  run.out.step_seconds *= count / (count - 1);
  run.out.newton_per_step /= count;
  run.out.solver_per_step /= count;
  return std::move(run.out);
}

tl::expected<Trajectory, Diagnostic> runge_kutta(const PrecisionScene& scene, int steps_per_sample, Loading loading) {
  const PrecisionMethod none;
  TACTUS_TRY(auto run, start(scene, none, loading));
  FemModel& model = run.model;
  Eigen::VectorXd inverse_mass = Eigen::VectorXd::Zero(model.size()), k(model.size());
  for (const int i : model.free_dofs()) inverse_mass[i] = 1 / model.lumped_mass()[i];
  const double h = scene.step(steps_per_sample), begin = processor_seconds();
  const auto acceleration = [&](const Eigen::VectorXd& u, double t) -> Eigen::VectorXd {
    external_forces(scene, model, loading, scene.patch.deflection(u), t, run.f);
    model.internal_forces(u, k);
    return inverse_mass.cwiseProduct(run.f - k);
  };
  auto& [u, v] = run.state;
  for (std::int64_t i = 0; i < std::int64_t{steps_per_sample} * scene.samples; ++i) {
    const double t = static_cast<double>(i) * h;
    const Eigen::VectorXd a1 = acceleration(u, t), v2 = v + h / 2 * a1;
    const Eigen::VectorXd a2 = acceleration(u + h / 2 * v, t + h / 2), v3 = v + h / 2 * a2;
    const Eigen::VectorXd a3 = acceleration(u + h / 2 * v2, t + h / 2), v4 = v + h * a3;
    const Eigen::VectorXd a4 = acceleration(u + h * v3, t + h);
    u += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    if ((i + 1) % steps_per_sample == 0) run.sample(static_cast<int>(i / steps_per_sample));
  }
  run.out.step_seconds = processor_seconds() - begin;
  return std::move(run.out);
}

tl::expected<Reference, Diagnostic> make_reference(const PrecisionScene& scene) {
  const int n = scene.reference_steps_per_sample;
  Reference out, half;
  Trajectory quarter;
  out.step = scene.step(n);
  const auto fill = [&](int steps, Loading loading, Trajectory& to) -> tl::expected<void, Diagnostic> {
    TACTUS_TRY(auto made, runge_kutta(scene, steps, loading));
    to = std::move(made);
    return {};
  };
  for (Reference* one : {&out, &half}) {
    const int steps = one == &out ? n : n / 2;
    for (const auto& [loading, to] : {std::pair{Loading::force, &one->load}, std::pair{Loading::probe, &one->probe},
                                      std::pair{Loading::weight, &one->weight}, std::pair{Loading::push, &one->push}})
      TACTUS_CHECK(fill(steps, loading, *to));
  }
  TACTUS_CHECK(fill(n / 4, Loading::force, quarter));
  out.floor = difference(half.load, out.load);
  out.floor.force = force_error(half.probe, out.probe);
  out.floor.weight = state_error(half.weight.u, out.weight.u);
  out.floor.push = state_error(half.push.u, out.push.u);
  out.order = std::log2(state_error(quarter.u, half.load.u) / out.floor.displacement);
  for (double* error : {&out.floor.displacement_end, &out.floor.displacement, &out.floor.velocity, &out.floor.force,
                        &out.floor.energy, &out.floor.weight, &out.floor.push})
    *error /= 15;  // of two results of order 4, the finer one's error is a fifteenth of their difference
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
    out.errors = {kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};
    out.remark = to_string(run.error());
    return out;
  }
  out.errors = difference(*run, reference.load);
  out.newton_per_step = run->newton_per_step;
  out.solver_per_step = run->solver_per_step;
  out.unconverged_steps = run->unconverged_steps;
  out.taken = run->taken;
  const auto probe = simulate(scene, method, steps_per_sample, Loading::probe);
  if (probe) out.errors.force = force_error(*probe, reference.probe);
  else out.remark = "probe: " + to_string(probe.error());
  if (const auto weight = simulate(scene, method, steps_per_sample, Loading::weight))
    out.errors.weight = state_error(weight->u, reference.weight.u);
  if (const auto push = simulate(scene, method, steps_per_sample, Loading::push))
    out.errors.push = state_error(push->u, reference.push.u);

  std::vector<Trajectory> runs;
  const bool once = run->setup_seconds + run->step_seconds > timing.longest_repeated;
  if (once) runs.push_back(*std::move(run));
  while (!once && static_cast<int>(runs.size()) < timing.runs) {
    auto again = simulate(scene, method, steps_per_sample, Loading::force);
    if (!again) return out;  // cannot happen: it repeats the first run
    runs.push_back(*std::move(again));
  }
  out.runs = static_cast<int>(runs.size());
  out.seconds_per_second = median(runs, &Trajectory::step_seconds) / scene.duration;
  out.setup_seconds = median(runs, &Trajectory::setup_seconds);
  return out;
}

}  // namespace tactus::sim::study
