// SPDX-License-Identifier: Apache-2.0
/// Codes true states of the rigid objects into payloads: a function of truth and baseline. Internal to the library; Sender is the
/// way in.
///
/// After every tick what a decoder shows obeys, for every object and contact given,
///   |x^ - x| <= visual_position,  angle(q^, q) <= visual_rotation,  haptic_ratio(f, f^) <= 1.
/// In a smoothed scene that is the smoothed path.
/// A bound finer than the grid (a small force_floor, a stiff contact) means the nearest grid point.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/packet/substream_encoder.h>
#include <tactus/rigid/awake_objects.h>
#include <tactus/rigid/curve.h>
#include <tactus/rigid/level_of_detail.h>
#include <tactus/rigid/rigid_bounds.h>
#include <tactus/rigid/rigid_states.h>
#include <tactus/rigid/rigid_syntax.h>
#include <tactus/rigid/rigid_truth.h>
#include <tactus/rigid/rigid_update.h>
#include <tactus/rigid/rigid_work.h>

namespace tactus {

/// A codec of SubstreamEncoder.
class RigidEncoder {
 public:
  using State = RigidStates;

  /// in   work    that it shares with other encoders of this truth; null: with none
  ///      device  path of the receiver's device; null: it is not known
  /// pre  RigidBounds::check(), and all that is given outlives the encoder
  RigidEncoder(const Scene& scene, const RigidTriggers& triggers, const SenderPolicy& policy, const RigidTruth& truth,
               RigidWork* work, const DevicePath* device);

  /// Code the tick that the truth was read for.
  /// time O(objects that move, are touched, or whose prediction does), < 1 us per object, < 4 us per update; what others found out with the
  ///      same: 50 ns and 100 ns. What rests costs nothing. No allocation.
  Result<Payload> encode(const EncodeRequest<RigidStates>& request, std::span<std::uint8_t> out) noexcept;
  void commit(const RigidStates& base, RigidStates& next) noexcept;
  void acknowledge(std::uint64_t number) noexcept;
  void forget_last() noexcept;
  void set_link(const LinkState& link) noexcept;
  void set_bound_scale(double factor) noexcept;  ///< of all thresholds.   pre  factor >= 1
  void set_viewpoints(std::span<const Vec3> viewpoints) noexcept;

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min() / 2;  // a tick

  /// What a receiver of every packet shows of an object.
  struct Sent {
    SmoothedPath path;
    std::uint64_t version = 0;    // of the path, where work is shared
    std::uint64_t number = 0;     // of the packet that brought it
    std::uint8_t follow_ups = 0;  // since a trigger asked for it
    bool acknowledged = true;
  };
  struct Pending {
    std::uint32_t object = 0;  // index into the scene
    Reason reason = Reason::request;
    bool follow_up = false;
    VersionedPath after;  // the state of its path is what the decoder will hold
  };

  void wake() noexcept;
  void wake(std::uint32_t object) noexcept;
  void look() noexcept;
  void choose_early() noexcept;
  std::uint8_t lod_of(std::uint32_t object) const noexcept { return levels_ ? levels_->of(object) : std::uint8_t{0}; }
  bool is_reference() const noexcept { return bounds_.triggers().reduction == Reduction::none; }
  void sleep() noexcept;
  std::optional<std::int64_t> sleeps_until(std::uint32_t object) noexcept;
  RigidDecision decide(std::uint32_t object, bool early) noexcept;
  RigidDecision decide_alone(const SmoothedPath& path, bool early) const noexcept;
  bool is_follow_up_due(std::uint32_t object) const noexcept;
  void collect(const EncodeRequest<RigidStates>& request) noexcept;
  bool is_silent() const noexcept { return silence_ > 0 && truth_.tick() - last_ >= silence_; }
  void add_joining(const EncodeRequest<RigidStates>& request) noexcept;
  Result<Payload> code_all(const EncodeRequest<RigidStates>& request, std::span<std::uint8_t> out) noexcept;
  bool uses_common_work() const noexcept;
  void make_key(const EncodeRequest<RigidStates>& request) noexcept;
  Payload copy(const RigidWork::Body& body, std::span<std::uint8_t> out) noexcept;

  const Scene& scene_;
  RigidBounds bounds_;
  RigidPredictor predictor_;
  RigidUpdateCoder updates_;
  bool acknowledges_;   // Baseline::acknowledged
  bool joins_early_;    // objects that are near their bounds join a packet
  bool waits_ = false;  // packets wait for their turn
  // Packets get lost: no device drives, as what the client does not know of it lasts for a round trip.
  bool loses_more_ = false, loses_much_ = false;
  std::array<std::int64_t, 3> follow_up_{};  // [ticks] without an acknowledgement before the first, the second and later; 0: none
  std::int64_t heartbeat_ = 0, silence_ = 0;           // [ticks], 0: off
  std::int64_t last_ = kNever, before_last_ = kNever;  // tick of the last payload, and of the one before
  const RigidTruth& truth_;
  RigidWork* work_;
  std::uint64_t read_ = 0;                // of the truth, that was looked at last
  std::optional<LevelsOfDetail> levels_;  // in a scene with interest
  AwakeObjects awake_;
  bool wakes_all_ = true;  // at the next tick
  bool has_begun_ = false;
  std::vector<Pending> pending_;
  std::uint64_t number_ = 0;                            // of the pending packet
  std::vector<Sent> sent_;                              // by object
  std::vector<std::pair<std::uint32_t, Sent>> before_;  // what the last packet replaced in it
  std::vector<std::uint32_t> key_;                      // of a payload that may be shared
  std::vector<VersionedPath*> after_;                   // of the pending
};

}  // namespace tactus
