// SPDX-License-Identifier: Apache-2.0
/// The true states of the rigid objects of a scene, tick by tick, and what follows from them alone: all encoders of one scene look at the
/// same. Internal to the library.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/rigid/encoder_choices.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/rigid/trigger.h>
#include <tactus/scene/scene.h>

namespace tactus {

class RigidTruth {
 public:
  /// pre  `scene` and `held` outlive this.   allocates
  RigidTruth(const Scene& scene, const RigidTriggers& triggers, HeldList& held);

  /// Take the truth of one tick. The spans must stay valid while encoders look at it. An object that breaks a rule is where it was last, at
  /// rest, and nothing touches it; a contact that breaks one does not count: both are noted in the list.
  /// in   moved  Truth::moved;  others  Sender::encode.   pre  the list has begun the tick, and ends it
  /// time 0.2 us per object that has moved; 10 ns per object that can move, where it is not known which; no allocation.
  /// err  R-API-5 a wrong count: nothing has changed
  Result<void> read(std::int64_t tick, std::span<const RigidSample> samples, std::span<const Contact> contacts,
                    std::optional<std::span<const std::uint32_t>> moved = {}) noexcept;

  std::int64_t tick() const noexcept { return tick_; }
  std::uint64_t reads() const noexcept { return reads_; }  ///< so far
  /// On the grid; its tick is that of the last change.
  const RigidState& state(std::uint32_t object) const noexcept { return states_[object]; }
  std::span<const RigidState> states() const noexcept { return states_; }
  std::span<const RigidSample> samples() const noexcept { return samples_; }
  const Contacts& contacts() const noexcept { return contacts_; }
  bool is_held(std::uint32_t object) const noexcept { return !held_.empty() && held_.has(TruthPart::object, object); }
  /// Objects that are not what they were at the last read().
  std::span<const std::uint32_t> moved() const noexcept { return moved_; }
  /// Objects that have ever been anywhere else than in their initial pose.
  std::span<const std::uint32_t> left() const noexcept { return left_; }
  bool has_moved(std::uint32_t object) const noexcept { return has_moved_since(reads_ - 1, object); }
  bool has_moved_since(std::uint64_t read, std::uint32_t object) const noexcept { return moved_at_[object] > read; }
  /// Objects that contacts name.
  std::span<const std::uint32_t> touched() const noexcept { return touched_; }
  bool is_touched(std::uint32_t object) const noexcept { return touched_at_[object] == reads_; }

  const Acceleration* acceleration() const noexcept {
    return acceleration_ ? &*acceleration_ : nullptr;
  }                                                                                                   ///< null: not looked at
  const ForceTrend* force_trend() const noexcept { return force_trend_ ? &*force_trend_ : nullptr; }  ///< null: not looked at
  const PastStates* past() const noexcept { return past_ ? &*past_ : nullptr; }                       ///< null: not looked at

 private:
  void read(std::span<const RigidSample> samples, std::optional<std::span<const std::uint32_t>> moved) noexcept;
  void take(std::uint32_t object, const RigidSample& sample) noexcept;
  void hold(std::uint32_t object, const char* rule) noexcept;
  bool look_at_held(std::span<const RigidSample> samples) noexcept;
  void read(std::span<const Contact> contacts) noexcept;
  void look_back() noexcept;

  const Scene& scene_;
  HeldList& held_;
  Contacts::Filter filter_;
  std::int64_t tick_ = -1;
  std::uint64_t reads_ = 0;
  std::vector<RigidState> states_;
  std::vector<RigidSample> last_;  // samples of the last read(); of what is held, its last good pose at rest
  std::span<const RigidSample> samples_;
  Contacts contacts_;
  std::vector<std::uint32_t> moved_, recent_;  // of now, of the last ticks
  std::vector<std::uint32_t> touched_, left_;
  std::vector<std::uint8_t> has_left_;                // by object
  std::vector<std::uint64_t> moved_at_, touched_at_;  // by object: the read
  std::optional<Acceleration> acceleration_;          // where updates look ahead or are smoothed
  std::optional<ForceTrend> force_trend_;             // where they are smoothed and forces count
  std::optional<PastStates> past_;                    // if there is a choice of predictors
};

}  // namespace tactus
