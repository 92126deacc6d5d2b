// SPDX-License-Identifier: Apache-2.0
/// The first look at a recording, over all of it or over the beginning of a pipe: what is there, when, in which frames, and what is wrong
/// with it. Statistics only: memory does not grow with the number of samples. Internal to the library.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tactus/base/diagnostic.h>
#include <tactus/trace/read_notes.h>
#include <tactus/trace/ros_clock.h>
#include <tactus/trace/ros_samples.h>
#include <tactus/trace/trace_file.h>

namespace tactus {

class RosSurvey {
 public:
  RosSurvey(RosSamples& samples, const ReadOptions& options) : samples_(samples), options_(options) {}
  void add(const RosSample& sample);
  /// All samples were added: decide. A rate, a clock, a beginning and the gap of each source follow.
  tl::expected<void, Diagnostic> end(const mcap::Reader& mcap);
  /// Say what was decided. in  whole  all of the recording was looked at
  void add_notes(const mcap::Reader& mcap, bool whole, ReadNotes& notes);

  std::uint32_t tick_rate() const noexcept { return tick_rate_; }
  std::uint64_t start() const noexcept { return start_; }
  std::uint64_t disorder() const noexcept { return steps_.disorder() + clock_.disorder(); }
  std::uint64_t gap(std::uint32_t source) const noexcept { return gaps_[source]; }  ///< [ns]
  bool moves(std::uint32_t source) const noexcept { return moving_[source]; }
  /// [ns] Log time; where that of a message is far from those around it, one between them.
  std::uint64_t log_of(const RosSample& sample) const;
  const SourceFacts& facts(std::uint32_t source) const noexcept { return facts_[source]; }
  ClockSteps& steps() noexcept { return steps_; }
  RosClock& clock() noexcept { return clock_; }
  /// A topic, or "frame hand of /tf".
  std::string location_of(std::uint32_t source) const;
  std::string text_of_time(std::uint64_t log) const;  ///< "at 3.021 s"

 private:
  struct Seen {
    std::uint64_t count = 0, log = 0;  // the first
  };
  struct Change {
    std::uint64_t count = 0, log = 0;
    std::uint32_t from = 0, to = 0;
  };
  void settle(std::optional<std::uint64_t> next);
  void take(const RosSample& sample);
  void add_good(const RosSample& sample, std::uint64_t log);
  void add_motion(SourceFacts& facts, const RosSample& sample) const;
  tl::expected<void, Diagnostic> check() const;
  void find_start();
  void note_clock(ReadNotes& notes) const;
  void note_stamps(ReadNotes& notes) const;
  void note_rate(ReadNotes& notes) const;
  void note_source(std::uint32_t source, ReadNotes& notes) const;
  void note_rest(std::uint32_t source, ReadNotes& notes) const;
  void note_gaps(std::uint32_t source, ReadNotes& notes) const;
  void note_frames(ReadNotes& notes);
  void note_topics(const mcap::Reader& mcap, ReadNotes& notes) const;

  RosSamples& samples_;
  const ReadOptions& options_;
  std::vector<SourceFacts> facts_;
  std::vector<RosSample> pending_;                  // of one message, until the log time of the next is known
  std::optional<std::uint64_t> last_log_;           // of the message before
  std::map<std::uint32_t, std::uint64_t> own_log_;  // of the last sample of each source
  std::map<std::uint64_t, std::uint64_t> strays_;   // by ordinal: the time that is taken
  std::vector<bool> moving_;
  std::vector<std::uint64_t> gaps_;
  std::map<std::pair<std::uint32_t, RosFault>, Seen> faults_;
  std::optional<RosSample> first_fault_{};
  std::map<std::uint32_t, Seen> ignored_;
  std::map<std::uint32_t, Change> changes_;  // of parents, or of the frame of a topic
  ClockSteps steps_;
  RosClock clock_;
  std::uint32_t tick_rate_ = 0, densest_ = 0;
  std::uint64_t start_ = 0, log_start_ = 0;
};

}  // namespace tactus
