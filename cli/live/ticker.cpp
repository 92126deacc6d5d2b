// SPDX-License-Identifier: Apache-2.0
#include "cli/live/ticker.h"

#include <poll.h>

#include <algorithm>

namespace tactus::cli {

std::uint64_t microseconds_now() noexcept {
  using namespace std::chrono;
  return static_cast<std::uint64_t>(duration_cast<microseconds>(steady_clock::now().time_since_epoch()).count());
}

bool Ticker::begin(std::uint64_t now) noexcept {
  if (now < due_ + period_) return false;
  due_ += period_;
  const std::uint64_t late = now - due_, whole = late / period_;
  missed_ += whole;
  due_ += whole * period_;
  ++ticks_;
  ++bins_[std::min<std::size_t>(late / 10, kBins - 1)];
  return true;
}

Ticker::Woken Ticker::wait(int socket, std::uint64_t timeout) {
  for (;;) {
    const std::uint64_t now = microseconds_now();
    if (begin(now)) return Woken::by_tick;
    const std::uint64_t until = std::max(now, std::min(due_ + period_, timeout));
    const auto left = static_cast<long>(until - now);
    const timespec time{left / 1'000'000, left % 1'000'000 * 1000};
    pollfd handle{socket, POLLIN, 0};
    if (ppoll(&handle, 1, &time, nullptr) != 0 || timeout <= microseconds_now()) {
      if (!begin(microseconds_now())) return Woken::by_socket;
      return Woken::by_tick;
    }
  }
}

double Ticker::lateness(double share) const noexcept {
  const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(ticks_));
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin)
    if ((seen += bins_[bin]) >= wanted && seen > 0) return 10.0 * static_cast<double>(bin + 1);
  return 0;
}

}  // namespace tactus::cli
