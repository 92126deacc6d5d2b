// SPDX-License-Identifier: Apache-2.0
/// What a reader of foreign files decided, because the file leaves it open or says it badly: which clock it took, what it interpolated, which
/// samples are missing, what it left out, what it lost to damage. Every decision that changes a number is reported; nothing is decided in
/// silence.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactus/base/result.h>

namespace tactus {

struct ReadNote {
  std::string where;        ///< topic, frame, column or file; empty: the whole recording
  std::string what;         ///< a sentence without a full stop: "not a number; held from the sample before"
  std::string first;        ///< where it was seen first: "at 3.021 s", "line 12"; may be empty
  std::uint64_t count = 1;  ///< how often
};

enum class OnDamage : std::uint8_t {
  refuse,
  skip
};  ///< skip: what is damaged is left out, as is a tick that lacks something then

/// What of a recording was left out because it is damaged.
struct ReadLoss {
  std::string file{};                            ///< of a recording of several files
  Error cause{};                                 ///< its offset is that of the record
  std::uint64_t bytes = 0;                       ///< of the file; 0: not known
  std::optional<std::uint64_t> from{}, until{};  ///< [ns] log times of what was lost, if something states them
};

/// Sees how far a long look at a recording has come.
class ReadWatcher {
 public:
  virtual ~ReadWatcher() = default;
  /// in  bytes  read;  all  of all files
  virtual void on_read(std::uint64_t bytes, std::uint64_t all) = 0;
};

/// Notes of one recording, each location and sentence once, with how often. What: in the singular; the count stands behind.
class ReadNotes {
 public:
  /// time O(notes): few; memory bounded by kMost notes, what comes after is counted in the last
  /// in  count  0: nothing is noted
  void add(std::string_view where, std::string_view what, std::string first = {}, std::uint64_t count = 1) {
    if (count == 0) return;
    const auto same = [&](const ReadNote& note) { return note.where == where && note.what == what; };
    const auto found = std::find_if(notes_.begin(), notes_.end(), same);
    if (found != notes_.end()) found->count += count;
    else if (notes_.size() < kMost) notes_.push_back({std::string(where), std::string(what), std::move(first), count});
    else if (notes_.size() == kMost) notes_.push_back({"", "more notes than are kept", std::move(first)});
    else ++notes_.back().count;
  }
  void add(const ReadNote& note) { add(note.where, note.what, note.first, note.count); }
  const std::vector<ReadNote>& all() const noexcept { return notes_; }

 private:
  static constexpr std::size_t kMost = 100;
  std::vector<ReadNote> notes_;
};

}  // namespace tactus
