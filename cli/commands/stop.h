// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <csignal>

namespace tactus::cli {

/// While it lives, an interrupt or a request to end is noted instead of obeyed, so that a command can close its files. The second one
/// is obeyed.
class StopOnSignal {
 public:
  StopOnSignal();
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

  static int caught() noexcept;  ///< the signal, 0: none
};

}  // namespace tactus::cli
