// SPDX-License-Identifier: Apache-2.0
/// What the operating system can do so that a thread wakes in time.
#pragma once

#include <string>
#include <vector>

namespace tactus::device {

/// Asked for, and granted or not.
struct Privilege {
  std::string name;  ///< "real-time priority"
  bool granted = false;
  std::string remedy;  ///< what grants it; empty if it was granted
};

/// For the calling thread and as long as this lives: real-time scheduling (SCHED_FIFO), memory that is never swapped out, and a
/// processor that does not sleep deeply. What is not granted is left as it is.
class RealTime {
 public:
  RealTime();
  ~RealTime();
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

  const std::vector<Privilege>& privileges() const noexcept { return privileges_; }
  /// "real-time priority, memory locked, no deep sleep", or "none".
  std::string granted() const;

 private:
  std::vector<Privilege> privileges_;
  int latency_ = -1;               // descriptor of the request, while it is open
  int policy_ = 0, priority_ = 0;  // before
};

}  // namespace tactus::device
