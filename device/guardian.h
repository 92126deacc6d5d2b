// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <memory>

#include <tactus/base/result.h>

namespace tactus::device {

/// A process that outlives ours. If ours ends without ~Guardian (killed, crashed), it does one last thing for a device that would keep
/// its last force; otherwise it ends with the guardian and does nothing. It cannot help while our process is stopped: the device is
/// still ours then.
class Guardian {
 public:
  /// in   last_act  runs in the other process, where no thread but its own goes on, and no file of ours is open. It may load libraries and
  ///                allocate. What it refers to is as it was at this call.
  /// err  limit_exceeded R-API-11: no process, or no line to it
  static Result<std::unique_ptr<Guardian>> start(const std::function<void()>& last_act);
  ~Guardian();
  Guardian(const Guardian&) = delete;
  Guardian& operator=(const Guardian&) = delete;

 private:
  Guardian(pid_t process, int line) noexcept : process_(process), line_(line) {}

  pid_t process_;
  int line_;  // closed when we end, however that happens
};

}  // namespace tactus::device
