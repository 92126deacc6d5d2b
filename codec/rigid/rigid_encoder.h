// SPDX-License-Identifier: Apache-2.0
/// Codes true states of the rigid objects into payloads: a function of truth and baseline. Internal to the library; Sender is the
/// way in.
///
/// After every tick what a decoder shows obeys, for every object and contact given,
///   |x^ - x| <= visual_position,  angle(q^, q) <= visual_rotation,  haptic_ratio(f, f^) <= 1.
/// In an eased scene that is the eased path.
/// A bound finer than the grid (a small force_floor, a stiff contact) means the nearest grid point.
/// The encoder picks for every update the coarsest grid level that keeps the quantised state well inside these bounds. It
/// evaluates the haptic error in floating point, which is an encoder's choice; decoding is in integers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/packet/substream_encoder.h>
#include <tactus/rigid/curve.h>
#include <tactus/rigid/encoder_choices.h>
#include <tactus/rigid/rigid_syntax.h>
#include <tactus/rigid/trigger.h>

namespace tactus {

/// Thresholds of a pose in grid units, shrunk so that the bound also holds for the unrounded truth.
struct PoseThresholds {
  std::int64_t distance_squared = 0;
  std::int64_t half_angle_squared = 0;  ///< (sin(angle / 2))^2 x 2^-60 of a quaternion of length 1
  unsigned level = 0;                   ///< coarsest grid level whose rounding stays well within
};

/// A codec of SubstreamEncoder.
class RigidEncoder {
 public:
  using State = RigidStates;

  /// R-API-4: a threshold is negative, NaN or finer than the grid.
  static Result<void> check(const RigidTriggers& triggers, const GridExponents& grid) noexcept;
  /// pre  check(), and `scene` outlives the encoder
  RigidEncoder(const Scene& scene, const RigidTriggers& triggers, Baseline baseline);

  /// Take the truth of one tick; changes nothing else.   in, err  Sender::encode
  Result<void> read(std::int64_t tick, std::span<const RigidSample> samples, std::span<const Contact> contacts) noexcept;
  /// pre  read() took the request's tick.   time O(objects), < 1 us per object, < 4 us per update; no allocation.
  /// err  invalid_argument R-API-7 the residual from the predicted pose exceeds what an update can code
  Result<Payload> encode(const EncodeRequest<RigidStates>& request, std::span<std::uint8_t> out) noexcept;
  void know(const DevicePath& path);  ///< of the receiver's device.   pre  it outlives the encoder.   allocates
  void commit(const RigidStates& base, RigidStates& next) noexcept;
  void acknowledge(std::uint64_t number) noexcept;
  void forget_last() noexcept;
  void set_link(const LinkState& link) noexcept;
  void set_widening(double factor) noexcept;  ///< of all thresholds.   pre  factor >= 1

 private:
  /// What a receiver of every packet shows of an object.
  struct Sent {
    EasedPath path;
    std::uint64_t number = 0;     // of the packet that said so
    std::uint8_t follow_ups = 0;  // since a trigger asked for it
    bool acknowledged = true;
  };
  struct Pending {
    std::uint32_t object = 0;  // index into the scene
    Reason reason = Reason::request;
    RigidState state;  // what the decoder will hold
    bool follow_up = false;
  };

  Reason reason_for(std::uint32_t object) const noexcept;
  bool can_improve(std::uint32_t object, const RigidPose& shown) const noexcept;
  double haptic_ratio_of(std::uint32_t object, const RigidPose& shown) const noexcept;
  bool is_touched(std::uint32_t object) const noexcept;
  bool is_follow_up_due(std::uint32_t object) const noexcept;
  bool joins(std::uint32_t object, const EncodeRequest<RigidStates>& request) const noexcept;
  void collect(const EncodeRequest<RigidStates>& request) noexcept;
  RigidTriggers widened_triggers() const noexcept;
  Predictor chosen(std::uint32_t object, const RigidTriggers& bounds) const noexcept;
  RigidState leaned(std::uint32_t object, const Acceleration::Motion& acceleration, const ErrorShare& share) const noexcept;
  UpdateCourse course_of(const RigidState& state, const RigidPose& kept, const RigidSample& truth,
                         const Acceleration::Motion& acceleration) const noexcept;
  void choose_ease(Pending& update, CodedUpdate& coded, const Acceleration::Motion& acceleration,
                   const ErrorShare& share) const noexcept;
  Result<CodedUpdate> quantise(Pending& update, const Prediction& prediction, const RigidState& told) const noexcept;
  Result<CodedUpdate> code(Pending& update, const EncodeRequest<RigidStates>& request) const noexcept;

  const Scene& scene_;
  RigidTriggers triggers_;
  RigidPredictor predictor_;
  double widening_ = 1;
  PoseThresholds visual_, fixed_, early_visual_;  // widened
  double early_ = 1;                              // share of its bounds over which an object joins a packet
  // Packets get lost: velocities do not lean, as curves over gaps end with them. More do: no device drives, as what the client does not
  // know of it lasts for a round trip.
  bool loses_ = false, loses_more_ = false;
  std::array<std::int64_t, 3> follow_up_{};  // [ticks] without an acknowledgement before the first, the second and later; 0: none
  std::int64_t heartbeat_ = 0;               // [ticks], 0: off
  std::optional<Acceleration> acceleration_;  // where updates lean or are eased
  std::optional<ForceTrend> force_trend_;     // where they are eased and forces count
  std::optional<PredictorChoice> choice_;     // if there is one
  std::optional<DrivenChoice> driven_;        // if the receiver's device may drive objects
  std::vector<RigidState> truth_;             // this tick, on the grid
  std::span<const RigidSample> samples_;      // this tick, as given
  std::span<const Contact> contacts_;
  std::vector<Pending> pending_;
  std::uint64_t number_ = 0;                            // of the pending packet
  std::vector<Sent> sent_;                              // by object
  std::vector<std::pair<std::uint32_t, Sent>> before_;  // what the last packet replaced in it
};

}  // namespace tactus
