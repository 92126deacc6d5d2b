// SPDX-License-Identifier: Apache-2.0
/// When the samples of a recording were: statistics of its log times and header stamps, and the clock that follows from them. Internal to
/// the library.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <tactus/trace/ros_samples.h>
#include <tactus/trace/trace_file.h>

namespace tactus {

/// Gaps between times that come one after the other, in memory that does not grow with their number: counts and sums by size.
class GapStatistics {
 public:
  void add(std::uint64_t time);

  struct Timing {
    double period = 0;  ///< [s] between samples, lost ones and pauses counted out; 0: unknown
    double median = 0;  ///< [s] gap
    double spread = 0;  ///< [s] standard deviation of gaps shorter than 1.5 periods
    double length = 0;  ///< [s] without pauses
    double bursts = 1;  ///< samples that come at once
    bool in_bursts() const noexcept { return bursts > 1; }
  };
  Timing timing() const;
  std::uint64_t count() const noexcept { return count_; }
  std::uint64_t first() const noexcept { return first_; }
  std::uint64_t last() const noexcept { return last_; }
  double length() const noexcept { return count_ == 0 ? 0 : 1e-9 * static_cast<double>(last_ - first_); }
  std::uint64_t equal() const noexcept { return equal_; }                           ///< times like the one before
  std::uint64_t backward() const noexcept { return backward_; }                     ///< times before the one before
  std::uint64_t farthest_back() const noexcept { return farthest_back_; }           ///< [ns]
  double largest() const noexcept { return 1e-9 * static_cast<double>(largest_); }  ///< [s] gap
  std::uint64_t longer_than(double seconds) const;                                  ///< gaps, to an eighth of an octave

 private:
  struct Bin {
    std::uint64_t count = 0;
    double sum = 0;  // [s]
  };
  std::map<std::uint16_t, Bin> bins_;
  std::uint64_t count_ = 0, first_ = 0, last_ = 0, equal_ = 0, backward_ = 0, farthest_back_ = 0, largest_ = 0;
};

/// Finds where the clock of a recording was set: back, where times of one channel fall and those of all channels lag from then on (messages
/// that merely cross between channels catch up), or forward, where those of one channel leap by about a year.
class ClockSteps {
 public:
  struct Step {
    std::uint64_t ordinal = 0;  ///< first message after it
    std::uint64_t at = 0;       ///< [ns] where the times had come
    std::int64_t added = 0;     ///< [ns] to all times from here on
  };
  /// One message; the sum of what is to be added to its time.
  void add(std::uint64_t ordinal, std::uint32_t source, std::uint64_t log);
  void end();
  std::int64_t added() const noexcept { return steps_.empty() ? 0 : steps_.back().added; }
  std::int64_t added_at(std::uint64_t ordinal) const noexcept;
  const std::vector<Step>& steps() const noexcept { return steps_; }
  /// [ns] by which a message may lag behind one that stands before it, steps apart
  std::uint64_t disorder() const noexcept { return disorder_; }

 private:
  struct Last {
    std::int64_t time = 0;
    std::uint64_t ordinal = 0;
  };
  std::map<std::uint32_t, Last> last_;
  std::vector<Step> steps_;
  std::int64_t high_ = 0;
  bool any_ = false;
  std::optional<Step> lagging_;  // since here, times are below high_
  std::uint64_t lag_ = 0, disorder_ = 0;
};

/// What is known of one source before the first frame.
struct SourceFacts {
  GapStatistics log, stamps;
  std::uint64_t samples = 0;  ///< good ones
  std::uint64_t stampless = 0;
  std::int64_t least_lag = 0, most_lag = 0;  ///< [ns] log time behind the stamp
  std::optional<RosSample> first{};          ///< good one
  std::uint32_t last_parent = 0;
  double moved = 0, turned = 0,
         speed = 0;              ///< most away from the first pose [m], [rad]; of a twist the largest velocity
  Vec3 before{}, before_that{};  ///< positions of the last two
  std::uint64_t returns = 0;     ///< positions where the one before the last was, and the last was elsewhere
  double return_distance = 0;    ///< [m] largest
  /// Its poses go to and fro between two positions.
  bool swings() const noexcept { return samples >= 8 && 2 * returns > samples; }
  bool stamps_are_usable() const noexcept;
};

/// The chosen time of every sample.
class RosClock {
 public:
  void choose(const std::vector<SourceFacts>& facts, const std::vector<bool>& moving, RosStamps wanted);
  bool takes_stamps() const noexcept { return takes_stamps_; }
  bool takes_stamp(std::uint32_t source) const noexcept { return uses_[source].stamp; }
  bool spreads(std::uint32_t source) const noexcept { return uses_[source].spread > 0; }
  /// [ns] added to the stamps of a source whose clock is another one
  std::int64_t offset(std::uint32_t source) const noexcept { return uses_[source].offset; }
  /// [ns] by which the order of these times may differ from that of the log
  std::uint64_t disorder() const noexcept { return disorder_; }
  /// Timing of a source by its clock.
  GapStatistics::Timing timing(std::uint32_t source, const std::vector<SourceFacts>& facts) const;
  /// in  added  what a step of the log's clock adds;   none: of that sample there is no time
  std::optional<std::uint64_t> time_of(const RosSample& sample, std::int64_t added);

 private:
  struct Use {
    bool stamp = false;
    std::int64_t offset = 0;
    std::uint64_t spread = 0;  // [ns] period of samples that come in bursts, without stamps that help
    std::int64_t far = 0;      // [ns] by which the log may differ from even times
    std::uint64_t last = 0;
  };
  std::vector<Use> uses_;
  bool takes_stamps_ = false;
  std::uint64_t disorder_ = 0;
};

/// The whole number of ticks per second that this timing means: the roundest one within its uncertainty.
std::uint32_t rate_of(const GapStatistics::Timing& timing) noexcept;

}  // namespace tactus
