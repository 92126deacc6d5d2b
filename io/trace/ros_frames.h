// SPDX-License-Identifier: Apache-2.0
/// What a recording tells at one tick: every source between its samples, and coordinate frames that hang on each other. Internal to the
/// library.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/trace/read_notes.h>
#include <tactus/trace/ros_samples.h>

namespace tactus {

/// The samples of one source around a tick. Between two that are not farther apart than the gap it follows a line and an arc; else it
/// rests at the one before. Of equal times the last sample counts.
class RosTrack {
 public:
  RosTrack(const std::optional<RosSample>& first, bool moves, std::uint64_t gap);
  void add(const RosSample& sample) { samples_.push_back(sample); }
  /// pre  times do not fall
  void move_to(std::uint64_t time);

  bool is_known() const noexcept { return first_.has_value(); }
  bool moves() const noexcept { return moves_; }
  bool has_begun() const noexcept { return has_begun_; }
  /// Something is recorded here: between two samples, or so near to one.
  bool covers(std::uint64_t near) const noexcept;
  bool is_between() const noexcept { return is_between_; }
  std::optional<std::uint64_t> next_time() const noexcept;
  /// Name of the frame in which the values are told.
  std::uint32_t frame() const noexcept { return before().frame; }
  /// Grows where the values jump: at the end of a gap, and when the frame changes.
  std::uint64_t jumps() const noexcept { return jumps_; }
  Pose pose() const noexcept;
  Twist twist() const noexcept;
  Vec3 force() const noexcept;

 private:
  const RosSample& before() const noexcept { return samples_.empty() ? *first_ : samples_.front(); }
  const RosSample& after() const noexcept { return is_between_ ? samples_[1] : before(); }
  bool are_joined(const RosSample& a, const RosSample& b) const noexcept;

  std::optional<RosSample> first_;  // where it stands before
  std::deque<RosSample> samples_;
  bool moves_, has_begun_ = false, is_between_ = false;
  std::uint64_t gap_, time_ = 0, jumps_ = 0;
  double share_ = 0;
};

/// Places of frames in the world at one tick. A frame that hangs on none is the world.
class RosFrames {
 public:
  struct Placed {
    Pose pose;                ///< in the world
    std::uint64_t chain = 0;  ///< differs when a frame on the way jumped or hangs elsewhere
  };
  RosFrames(RosSamples& samples, const std::vector<RosTrack>& tracks, ReadNotes& notes);
  /// Everything may have moved.
  void move() noexcept { ++generation_; }
  /// Of a frame as topics of this space call it.   time O(1) on average over all frames of a tick
  Placed at(std::uint32_t space, std::uint32_t frame);
  Placed of_link(std::uint32_t link);

 private:
  struct State {
    std::uint64_t computed = 0, seen = 0;
    bool is_cut = false;
    Placed placed{};
  };
  RosSamples& samples_;
  const std::vector<RosTrack>& tracks_;
  ReadNotes& notes_;
  std::vector<State> states_;
  std::vector<std::uint32_t> chain_;  // room for of_link()
  std::uint64_t generation_ = 1;
};

}  // namespace tactus
