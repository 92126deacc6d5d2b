// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/stop.h"

#include <atomic>

namespace tactus::cli {
namespace {

constexpr std::array<int, 2> kSignals{SIGINT, SIGTERM};

// Read and written by a signal handler.
std::atomic<int> caught_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);
std::array<struct sigaction, 2> before;  // what was done about kSignals
std::array<bool, 2> is_ours{};

void restore() {
  for (std::size_t i = 0; i < kSignals.size(); ++i)
    if (is_ours[i]) sigaction(kSignals[i], &before[i], nullptr);
}

extern "C" void note(int signal) {
  caught_signal = signal;
  restore();
}

}  // namespace

StopOnSignal::StopOnSignal() {
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], nullptr, &before[i]);
    is_ours[i] = before[i].sa_handler != SIG_IGN;  // whoever started the program may want it ignored
    if (is_ours[i]) sigaction(kSignals[i], &action, nullptr);
  }
}

StopOnSignal::~StopOnSignal() { restore(); }

int StopOnSignal::caught() noexcept { return caught_signal; }

}  // namespace tactus::cli
