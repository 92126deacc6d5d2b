// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/trace/mcap_reader.h>
#include <tactus/trace/messages.h>
#include <tactus/trace/ros_frames.h>
#include <tactus/trace/ros_messages.h>

namespace tactus {

/// What a recording says of one thing at one time.
struct RosSample {
  enum class Kind : std::uint8_t { pose, twist, force, transform };
  Kind kind{};
  std::uint32_t source = 0;  ///< the channel; of a transform, the frame that hangs
  std::uint32_t frame = 0;   ///< the frame in which it is told; of forces and transforms
  std::uint64_t time = 0;    ///< [ns] log time
  Pose pose{};               ///< of a pose and a transform
  Twist twist{};             ///< of a twist
  Vec3 force{};              ///< [N]
};

/// The poses, twists, forces and transforms of a recording, in the order of its messages.
class RosSamples {
 public:
  explicit RosSamples(mcap::Item first) : item_(first) {}

  /// The next one; none at the end.   err  those of reading and decoding, with the place
  Result<std::optional<RosSample>> next(mcap::Reader& mcap);
  /// Names of frames are kept from here on: one that is new is refused.   err  of next(), then: unsupported R-TRC-16
  void close_frames() noexcept { frames_are_closed_ = true; }

  RosFrames& frames() noexcept { return frames_; }

 private:
  Result<void> take(mcap::Reader& mcap);
  Result<void> take_transforms(mcap::Reader& mcap, bool is_list);
  Result<std::uint32_t> frame(std::string_view name);

  mcap::Item item_;  // where the reader stands
  RosFrames frames_;
  bool frames_are_closed_ = false;
  std::deque<RosSample> waiting_;  // of the last message
  std::vector<RosTransform> transforms_;
};

}  // namespace tactus
