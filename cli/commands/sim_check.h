// SPDX-License-Identifier: Apache-2.0
/// The error of a simulation, by what a smaller step makes of the same scene, seed and hands. Runs of their own processes beside the one
/// that is checked, as rigid worlds of one process share a random generator.
#pragma once

#include <sys/resource.h>
#include <sys/types.h>

#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <tactus/sim/simulation.h>
#include "cli/output.h"
#include "cli/report/report.h"

namespace tactus::cli {

/// What is compared of a run, one tick at a time.
class CheckedTick {
 public:
  /// Before a tick of the simulation, and after it.
  void begin(sim::Simulation& simulation) { simulation.energies(energies); }
  void end(const TraceFrame& of_tick);

  const TraceFrame* frame = nullptr;  ///< valid until the next tick
  std::vector<double> energies;       ///< [J] as Simulation::energies, of this tick
  std::vector<double> works;          ///< [J] of each user's hand, so far

 private:
  std::vector<Vec3> forces_;     // [N] on the hands in the tick before,
  std::vector<Vec3> positions_;  // [m] and where they were
};

class SimCheck {
 public:
  /// One tick of the finer run; null: it has ended, or failed and was said.
  using Step = std::function<const CheckedTick*()>;

  /// Start a process with what `make` makes there.   pre  no thread was started
  /// in   against  what is finer: "half the step"
  static tl::expected<SimCheck, Failure> start(const TraceInfo& info, std::string against, const std::function<Step()>& make);

  /// Compare the next tick, and keep the largest differences.
  /// err  the finer run ended early
  Outcome add(const CheckedTick& own);
  CheckReport finish();  ///< waits for its end

  SimCheck(SimCheck&&) noexcept = default;
  SimCheck& operator=(SimCheck&&) noexcept = default;
  ~SimCheck();  ///< ends the process

 private:
  struct Close {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };
  SimCheck(const TraceInfo& info, std::string against);
  rusage end() noexcept;

  CheckReport report_;
  std::vector<Vec3> starts_;                // [m] of objects
  std::vector<double> first_energies_;      // [J] as CheckedTick::energies
  std::vector<std::vector<float>> meshes_;  // of the finer run, newest
  std::unique_ptr<std::FILE, Close> pipe_;
  pid_t child_ = -1;
  double tick_ = 0;  // [s] of one
};

}  // namespace tactus::cli
