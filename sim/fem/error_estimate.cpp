// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/error_estimate.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace tactus::sim {
namespace {

constexpr std::size_t kMost = 4096;  ///< samples; when full, every second sample is dropped and the sampling interval doubles

int order(Method method) { return method == Method::backward_euler || method == Method::projective ? 1 : 2; }

}  // namespace

tl::expected<std::unique_ptr<ErrorEstimate::Copy>, Diagnostic> ErrorEstimate::copy(const FemModel& model,
                                                                                   const IntegratorOptions& options) {
  TACTUS_TRY(auto again, FemModel::create(model.mesh(), model.options()));
  auto made = std::make_unique<Copy>(Copy{std::move(again), nullptr});
  TACTUS_TRY(auto integrator, make_integrator(made->model, options));
  made->integrator = std::move(integrator);
  return made;
}

tl::expected<ErrorEstimate, Diagnostic> ErrorEstimate::create(const FemModel& model, const IntegratorOptions& options,
                                                              std::int64_t every) {
  TACTUS_TRY(auto whole, copy(model, options));
  IntegratorOptions halved = options;
  halved.step /= 2;
  TACTUS_TRY(auto half, copy(model, halved));
  return ErrorEstimate(std::move(whole), std::move(half), std::max<std::int64_t>(every, 1));
}

ErrorEstimate::ErrorEstimate(std::unique_ptr<Copy> whole, std::unique_ptr<Copy> half, std::int64_t every)
    : whole_(std::move(whole)), half_(std::move(half)), every_(every), coarse_(whole_->model.rest()), fine_(coarse_) {
  const double power = 1 << order(whole_->integrator->options().method);
  order_factor_ = power / (power - 1);
  errors_.reserve(kMost);
}

void ErrorEstimate::look(const Eigen::VectorXd& f, const FemState& state) {
  if (calls_++ % every_ != 0) return;
  if (errors_.size() == kMost) {
    for (std::size_t i = 0; i < kMost / 2; ++i) errors_[i] = errors_[2 * i];
    errors_.resize(kMost / 2);
    every_ *= 2;
  }
  errors_.push_back(relative_error(f, state));
}

double ErrorEstimate::relative_error(const Eigen::VectorXd& f, const FemState& state) {
  coarse_ = state;
  fine_ = state;
  if (!whole_->integrator->step(f, coarse_)) return std::numeric_limits<double>::infinity();
  for (int i = 0; i < 2; ++i)
    if (!half_->integrator->step(f, fine_)) return std::numeric_limits<double>::infinity();
  const double size = fine_.u.norm();
  return size == 0 ? 0 : order_factor_ * (coarse_.u - fine_.u).norm() / size;
}

ErrorEstimate::Result ErrorEstimate::result() const {
  if (errors_.empty()) return {};
  std::vector<double> sorted = errors_;
  std::sort(sorted.begin(), sorted.end());
  return {sorted[sorted.size() / 2], sorted.back(), static_cast<std::int64_t>(sorted.size())};
}

}  // namespace tactus::sim
