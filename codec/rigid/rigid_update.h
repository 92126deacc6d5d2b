// SPDX-License-Identifier: Apache-2.0
/// What an update of a rigid object says: its predictor and velocities, how it is smoothed, on which grid level it is rounded: the coarsest that
/// keeps the quantised state well inside all bounds. Informative: an encoder's choice. Internal to the library.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/rigid/curve.h>
#include <tactus/rigid/encoder_choices.h>
#include <tactus/rigid/rigid_bounds.h>
#include <tactus/rigid/rigid_syntax.h>
#include <tactus/rigid/rigid_truth.h>

namespace tactus {

class RigidUpdateCoder {
 public:
  /// in   device  path of the receiver's device; null: it is not known
  /// pre  all that is given outlives the coder, which stays where it is
  RigidUpdateCoder(const Scene& scene, const RigidTruth& truth, const RigidBounds& bounds, const RigidPredictor& predictor,
                   const DevicePath* device);
  RigidUpdateCoder(const RigidUpdateCoder&) = delete;
  RigidUpdateCoder& operator=(const RigidUpdateCoder&) = delete;

  /// The truth of a tick, after those before it.   in   drives  the receiver's device may drive objects
  void read(bool drives) noexcept;
  void set_looks_ahead(bool looks_ahead) noexcept { looks_ahead_ = looks_ahead; }
  bool looks_ahead() const noexcept { return looks_ahead_; }

  /// What an update is for, and what it builds on.
  struct Request {
    std::uint32_t object = 0;
    Reason reason = Reason::request;
    std::uint8_t lod = 0;
    const RigidState& base;     ///< of the baseline
    const SmoothedPath& shown;  ///< so far
    bool key = false;
  };
  struct Update {
    CodedUpdate coded;
    RigidState state;  ///< what a decoder makes of it
  };
  /// time < 4 us, no allocation
  Result<Update> code(const Request& request) const noexcept;

 private:
  /// What is known of the object, with which an update looks ahead.
  struct Outlook {
    Acceleration::Motion acceleration;
    ErrorRatio ratio;
  };
  struct DrivenParts {
    DrivenParts(const Scene& scene, const DevicePath& path) : choice(scene, path), past(scene), signalled(scene.objects.size()) {}
    DrivenChoice choice;
    PastStates past;
    std::vector<DrivenContact> signalled;  // by object
  };

  RigidState truth_of(const Request& request) const noexcept;
  Predictor chosen(const Request& request, const RigidState& truth, const RigidTriggers& bounds) const noexcept;
  RigidState with_look_ahead(const RigidState& truth, std::uint32_t object, const Outlook& outlook) const noexcept;
  ErrorTrajectory error_trajectory(const RigidState& state, const RigidPose& kept, const RigidSample& truth,
                                   const Acceleration::Motion& acceleration) const noexcept;
  void choose_smoothing(const Request& request, const Outlook& outlook, Update& update) const noexcept;
  Result<Update> quantise(const Request& request, const RigidState& signalled) const noexcept;

  const Scene& scene_;
  const RigidTruth& truth_;
  const RigidBounds& bounds_;
  const RigidPredictor& predictor_;
  bool looks_ahead_ = true;                // velocities do
  std::optional<DrivenParts> driven_;      // if the receiver's device may drive objects
  std::optional<PredictorChoice> choice_;  // if there is one
};

}  // namespace tactus
