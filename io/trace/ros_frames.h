// SPDX-License-Identifier: Apache-2.0
/// What a recording holds at one tick: every source between its samples, and coordinate frames that hang on each other. Internal to the
/// library.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/trace/read_notes.h>
#include <tactus/trace/ros_samples.h>
#include <tactus/trace/sample_track.h>

namespace tactus {

/// The samples of one source around a tick (sample_track.h). Before the first one it stands there.
class RosTrack {
 public:
  /// in  gap, tick  [ns]
  RosTrack(const std::optional<RosSample>& first, bool moves, std::uint64_t gap, std::uint64_t tick);
  void add(const RosSample& sample);
  /// pre  times do not fall
  void move_to(std::uint64_t time) { track_.move_to(static_cast<std::int64_t>(time)); }
  bool is_settled(std::uint64_t time, std::uint64_t known) const noexcept;

  bool is_known() const noexcept { return first_.has_value(); }
  bool moves() const noexcept { return moves_; }
  /// Something is recorded here: between two samples, or so near to one.
  bool covers(std::uint64_t near) const noexcept { return track_.is_near(static_cast<double>(near)); }
  std::optional<std::uint64_t> next_time() const noexcept;
  /// Name of the frame in which the values are expressed.
  std::uint32_t frame() const noexcept { return has_samples() ? track_.frame() : first_->frame; }
  /// Of a pose or link, as it moves; of a twist, as it was published.
  RigidSample state() noexcept;
  Vec3 force() const noexcept { return has_samples() ? track_.vector() : Vec3{}; }
  /// None where nothing is known.
  std::optional<Twist> twist(std::uint64_t near) const noexcept;

 private:
  using Track = SampleTrack<std::int64_t>;
  bool has_samples() const noexcept { return track_.relation() != Track::Relation::nowhere; }

  std::optional<RosSample> first_;  // where it stands before
  Track track_;
  bool moves_;
};

/// What hangs on a frame that moves, in the world.
RigidSample hung(const RigidSample& frame, const RigidSample& own) noexcept;

/// Poses of frames in the world at one tick, and how they move. A frame that hangs on none is the world.
class RosFrames {
 public:
  RosFrames(RosSamples& samples, std::vector<RosTrack>& tracks, ReadNotes& notes);
  /// Everything may have moved.
  void move() noexcept { ++generation_; }
  /// Of a frame as topics of this space call it.   time O(1) on average over all frames of a tick
  RigidSample at(std::uint32_t space, std::uint32_t frame);
  RigidSample of_link(std::uint32_t link);

 private:
  struct State {
    std::uint64_t computed = 0, seen = 0;
    bool is_cut = false;
    RigidSample placed{};
  };
  RosSamples& samples_;
  std::vector<RosTrack>& tracks_;
  ReadNotes& notes_;
  std::vector<State> states_;
  std::vector<std::uint32_t> chain_;  // room for of_link()
  std::uint64_t generation_ = 1;
};

}  // namespace tactus
