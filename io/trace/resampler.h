// SPDX-License-Identifier: Apache-2.0
/// A trace at another rate. Between two frames positions, velocities and forces follow a straight line and rotations an arc; contacts,
/// buttons and shapes are those of the frame before, and reports come with the next frame, if there is one. Nothing is filtered: a
/// lower rate needs a recording without faster motion.
#pragma once

#include <cstdint>
#include <vector>

#include <tactus/trace/frame.h>

namespace tactus {

class Resampler {
 public:
  /// in   tick_rate  wanted [1/s], 1 .. kMaxTickRate;  gap  [s] no frames are made between two that are farther apart
  /// pre  info is valid and does not show the past
  Resampler(const TraceInfo& info, std::uint32_t tick_rate, double gap);

  /// Of the new trace. Bounds of a stream do not hold between its ticks, so it has none.
  const TraceInfo& info() const noexcept { return info_; }
  /// The next frame of the recording.   pre  next() has returned false
  void add(const TraceFrame& frame);
  /// No more come.
  void end() noexcept { ended_ = true; }
  /// out  frame  the next one that is due;  false: there is none before more is added    time O(objects + users), of new shapes O(V)
  bool next(TraceFrame& frame);

 private:
  /// Time since tick 0, exactly: both rates divide a second into whole parts.
  struct Instant {
    std::int64_t second = 0, part = 0;
    friend bool operator==(const Instant&, const Instant&) = default;
    friend bool operator<(const Instant& a, const Instant& b) noexcept {
      return a.second != b.second ? a.second < b.second : a.part < b.part;
    }
  };
  Instant at(std::int64_t tick, std::uint32_t rate, std::uint32_t other) const noexcept;
  double between(const Instant& from, const Instant& to) const noexcept;  // [s]
  std::int64_t first_at_or_after(const Instant& time) const noexcept;     // tick of the new trace
  void note_news();
  void make(double fraction, TraceFrame& out);

  TraceInfo info_;
  std::uint32_t from_rate_;
  double gap_;
  TraceFrame before_, after_;
  Instant from_, to_;
  std::int64_t tick_ = 0;
  std::uint64_t frames_ = 0;             // added
  std::vector<bool> is_new_;             // shapes since the last frame
  std::vector<DeviceReports> reported_;  // by each user since then
  bool ended_ = false;
};

}  // namespace tactus
