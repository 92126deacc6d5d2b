// SPDX-License-Identifier: Apache-2.0
/// Which predictor an update chooses: the one that would have served longest of late. Each is started from true states of the last 150 ms
/// and held against the truth of now, from the youngest start back until one would have left its bounds; the device's motion, which takes
/// longer to work out, from where the best of the others would have left them, and not at all where it has in fact served for longer than
/// that. What a device touches is predicted by it or linearly. Informative: an encoder's choice, which no bound depends on. Internal to the
/// library.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <tactus/rigid/rigid_predictor.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/scene/scene.h>

namespace tactus {

/// The errors of a shown pose that end an update.
struct PermittedError {
  double position = 0;  ///< [m]
  double rotation = 0;  ///< [rad]
};

class PredictorChoice {
 public:
  /// pre  `scene` outlives this, and has motion constants
  explicit PredictorChoice(const Scene& scene);

  void know(const DevicePath& path) { predictor_.know(path); }  ///< RigidPredictor::know

  /// The truth of a tick, after those before it.   time O(moving objects), about 10 ns each, no allocation; memory 2 kB per object
  void read(std::int64_t tick, std::span<const RigidState> truth) noexcept;
  /// in   truth       the object's state of the last read(); where a device drives it, its contact is told
  /// in   is_touched  by a device, known or not;  current  the update that it replaces
  /// time < 2 us; where a device drives the object 0.1 us more for each tick of the path looked at, most often 50; no allocation
  Predictor choose(std::uint32_t object, const RigidState& truth, const PermittedError& permitted, bool is_touched,
                   const RigidState& current) const noexcept;

 private:
  static constexpr std::size_t kKept = 32;

  /// What a predictor would have done.
  struct Record {
    std::size_t served = 0;  // starts from which the error is within what is permitted
    double error = 0;        // sum over them
  };

  /// The n-th youngest state that predictors are started from; null: there is none, or it says nothing of `now`.
  const RigidState* start(std::uint32_t object, std::int64_t now, std::size_t n) const noexcept;
  double error_of(Predictor predictor, std::uint32_t object, RigidState from, const RigidState& truth,
                  const PermittedError& permitted) const noexcept;
  Record record_of(Predictor predictor, std::uint32_t object, const RigidState& truth,
                   const PermittedError& permitted) const noexcept;
  bool is_declared_for(std::uint32_t object, Predictor predictor) const noexcept;  // ballistic or slide
  /// Whether the device has driven the object for longer than a linear motion would have served.
  bool drives_on(std::uint32_t object, const RigidState& truth, const PermittedError& permitted,
                 const RigidState& current) const noexcept;
  /// Whether the device explains more than the best of the others, from the first start on that this one does not serve.
  bool is_driven(std::uint32_t object, const RigidState& truth, const PermittedError& permitted, Predictor other,
                 std::size_t served) const noexcept;

  const Scene& scene_;
  RigidPredictor predictor_;
  std::int64_t spacing_;          // [ticks] between states that are kept
  std::int64_t longest_;          // [ticks] older states say nothing of now
  std::size_t newest_ = 0;        // of the ring
  std::size_t count_ = 0;         // kept
  std::vector<RigidState> past_;  // kKept per object
};

}  // namespace tactus
