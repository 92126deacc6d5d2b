// SPDX-License-Identifier: Apache-2.0
/// What a device did, recorded and replayed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include <tactus/base/diagnostic.h>
#include <tactus/device/device.h>
#include <tactus/trace/frame.h>

namespace tactus::device {

// ==== recording ====

struct RecordingOptions {
  std::string user{};        ///< empty: the first
  double playback_rate = 1;  ///< 0.5: half as fast, > 0
  bool loops = false;
};

struct RecordedSample {
  std::int64_t tick = 0;
  DeviceSample sample{};
  Vec3 force{};  ///< [N] on the hand
};

/// What the hand of one user of a trace did, and the force on it, by time, at its own rate, slower, faster, or again and again. All of it is read
/// when it is opened, so that no tick waits for a file.
class Recording {
 public:
  struct Moment {
    DeviceSample sample{};  ///< positions and velocities between samples are interpolated; the rest is the sample's before
    Vec3 force{};           ///< [N] on the hand, interpolated
    Time into = 0;          ///< since the recording began, or began again
    bool is_over = false;   ///< the moment is its last sample
  };

  /// err  R-TRC-n of reading; invalid_argument R-DEV-1: no such user; R-API-4: playback_rate; limit_exceeded R-API-11: over 10^7 samples
  static tl::expected<Recording, Diagnostic> read(const std::string& path, const RecordingOptions& options);

  /// in   since  the beginning; before it, the beginning
  /// time O(1) if `since` grows by a few samples at a time; no allocation
  Moment at(Time since) noexcept;

  const TraceUser& user() const noexcept { return user_; }
  double rate() const noexcept { return rate_; }     ///< [Hz] of its samples, at playback_rate 1
  const Vec3& low() const noexcept { return low_; }  ///< [m] corners of what the hand reached
  const Vec3& high() const noexcept { return high_; }
  const Vec3& begin() const noexcept { return samples_.front().sample.position; }  ///< [m]

 private:
  Recording(TraceUser user, double rate, std::vector<RecordedSample> samples, const RecordingOptions& options);

  TraceUser user_;
  double rate_;
  std::vector<RecordedSample> samples_;  // not empty
  double ticks_per_ns_;
  bool loops_;
  Vec3 low_, high_;
  std::size_t next_ = 0;  // the first sample behind the last moment
};

// ==== replay device ====

/// A recording as a device; it takes no force. The time of a sample is the recording's.
/// in   path  a trace; its frame of coordinates is taken as the device's
/// err  those of Recording::read
tl::expected<std::unique_ptr<Device>, Diagnostic> open_replay_device(const std::string& path, const RecordingOptions& options);

}  // namespace tactus::device
