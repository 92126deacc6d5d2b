// SPDX-License-Identifier: Apache-2.0
/// The truth of the last ticks, for judging a client that shows the past.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <tactus/trace/frame.h>

namespace tactus {

class PastFrames {
 public:
  /// in   ticks  how many are kept
  explicit PastFrames(std::size_t ticks) : frames_(ticks) {}

  /// Keep objects and users of a frame.   time O(objects + users); no allocation once all slots were used
  void add(const TraceFrame& frame) {
    TraceFrame& kept = frames_[static_cast<std::size_t>(frame.tick) % frames_.size()];
    kept.tick = frame.tick;
    kept.objects = frame.objects;
    kept.users = frame.users;
    count_ = frame.tick + 1;
  }
  /// Null: it is not kept any more, or was never there.
  const TraceFrame* at(std::int64_t tick) const noexcept {
    if (tick < 0 || tick >= count_ || tick + static_cast<std::int64_t>(frames_.size()) < count_) return nullptr;
    const TraceFrame& kept = frames_[static_cast<std::size_t>(tick) % frames_.size()];
    return kept.tick == tick ? &kept : nullptr;
  }

 private:
  std::vector<TraceFrame> frames_;
  std::int64_t count_ = 0;
};

}  // namespace tactus
