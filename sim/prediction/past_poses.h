// SPDX-License-Identifier: Apache-2.0
/// Where an object was in the last ticks. One that does not move takes no time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tactus/base/geometry.h>

namespace tactus::sim {

class PastPoses {
 public:
  /// in   first  pose at all ticks before the first add()
  ///      ticks  how many poses are kept
  PastPoses(const Pose& first, std::size_t ticks) : entries_(std::max<std::size_t>(1, ticks)) {
    entries_[0] = {INT64_MIN, first};
  }

  /// The pose of a tick, later than all before; nothing if it is the last one.   time O(1), no allocation
  void add(std::int64_t tick, const Pose& pose) noexcept {
    const Pose& last = back(0).pose;
    if (pose.position == last.position && pose.rotation == last.rotation) return;
    next_ = (next_ + 1) % entries_.size();
    count_ = std::min(count_ + 1, entries_.size());
    entries_[next_] = {tick, pose};
  }
  /// The pose at a tick, or the oldest that is kept.   time O(log ticks)
  const Pose& at(std::int64_t tick) const noexcept {
    std::size_t newer = 0, older = count_ - 1;  // back(older) is not later than the tick, or the oldest
    while (newer < older) {
      const std::size_t middle = (newer + older) / 2;
      if (back(middle).tick <= tick) older = middle;
      else newer = middle + 1;
    }
    return back(older).pose;
  }

 private:
  struct Entry {
    std::int64_t tick = 0;
    Pose pose;
  };
  const Entry& back(std::size_t i) const noexcept { return entries_[(next_ + entries_.size() - i) % entries_.size()]; }

  std::vector<Entry> entries_;  // ring
  std::size_t next_ = 0;        // the newest
  std::size_t count_ = 1;
};

}  // namespace tactus::sim
