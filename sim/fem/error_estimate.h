// SPDX-License-Identifier: Apache-2.0
/// Error of single steps by step doubling: one whole step against two half ones from the same state, for some of the steps, on a
/// copy of the model. The simulation's results do not depend on it.
///   error of the whole step = 2^p / (2^p - 1) |u_whole - u_halves|,  p the order        relative to |u_halves|
#pragma once

#include <vector>

#include <tactus/sim/fem/integrator.h>

namespace tactus::sim {

class ErrorEstimate {
 public:
  struct Result {
    double p50 = 0, max = 0;  ///< relative error of one step; 0 without samples
    std::int64_t samples = 0;
  };

  /// in  every  estimate every n-th step   err  as make_integrator
  static tl::expected<ErrorEstimate, Diagnostic> create(const FemModel& model, const IntegratorOptions& options,
                                                        std::int64_t every = 50);

  /// Report a step before it is taken.   time three steps if it is estimated, else nothing; no allocation after the first
  /// estimate
  void look(const Eigen::VectorXd& f, const FemState& state);
  Result result() const;  ///< allocates

 private:
  struct Copy {  // stays where it is: the integrator refers to the model
    FemModel model;
    std::unique_ptr<Integrator> integrator;
  };
  ErrorEstimate(std::unique_ptr<Copy> whole, std::unique_ptr<Copy> half, std::int64_t every);
  static tl::expected<std::unique_ptr<Copy>, Diagnostic> copy(const FemModel& model, const IntegratorOptions& options);
  double relative_error(const Eigen::VectorXd& f, const FemState& state);

  std::unique_ptr<Copy> whole_, half_;
  std::int64_t every_, calls_ = 0;
  double order_factor_;
  FemState coarse_, fine_;
  std::vector<double> errors_;
};

}  // namespace tactus::sim
