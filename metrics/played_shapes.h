// SPDX-License-Identifier: Apache-2.0
/// Shapes of a client that shows the past, against the truth of their tick.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tactus/client/replica.h>
#include <tactus/metrics/deformable_errors.h>

namespace tactus {

/// Keeps the true shapes of a deformable object until the client shows their ticks, and then judges it.
class PlayedShapes {
 public:
  /// in   object  of the scene;  most  shapes kept: a client that lags by more is not judged on the oldest
  PlayedShapes(std::size_t object, DeformableErrors errors, std::size_t most)
      : object_(object), errors_(std::move(errors)), most_(most) {}

  /// A true shape.   in  tick  rising;  displacements, touch  as DeformableErrors::add
  void add(std::int64_t tick, std::span<const float> displacements, const std::optional<SurfaceTouch>& touch) {
    if (waiting_.size() == most_) waiting_.pop_front();
    waiting_.push_back({tick, {displacements.begin(), displacements.end()}, touch});
  }
  /// The client shows this tick now.   in  shown  never falls   time O(V) for each shape whose time has come
  void look(Replica& replica, std::int64_t shown) {
    for (; !waiting_.empty() && waiting_.front().tick <= shown; waiting_.pop_front()) {
      const Shape& shape = waiting_.front();
      if (started_) errors_.add(shape.displacements, replica.displacements(object_, shape.tick), shape.touch);
    }
    started_ = true;
  }
  const DeformableErrors& errors() const& noexcept { return errors_; }
  DeformableErrors errors() && noexcept { return std::move(errors_); }

 private:
  struct Shape {
    std::int64_t tick;
    std::vector<float> displacements;
    std::optional<SurfaceTouch> touch;
  };
  std::size_t object_;
  DeformableErrors errors_;
  std::size_t most_;
  std::deque<Shape> waiting_;
  bool started_ = false;  // what was due before the client showed anything is not judged
};

}  // namespace tactus
