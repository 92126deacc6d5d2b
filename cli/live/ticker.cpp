// SPDX-License-Identifier: Apache-2.0
#include "cli/live/ticker.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>
#include <algorithm>
#include <atomic>

#include "cli/output.h"
#include "cli/progress.h"

namespace tactus::cli {

// ==== stop ====

namespace {

constexpr std::array<int, 3> kSignals{SIGINT, SIGTERM, SIGUSR1};

// Read and written by a signal handler.
std::atomic<int> caught_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);
std::array<struct sigaction, kSignals.size()> before;  // what was done about kSignals
std::array<bool, kSignals.size()> is_ours{};

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
  remove_unfinished_on_signals();  // before: a file that is begun while this program runs must not take over
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

// ==== hang-up ====

namespace {

std::atomic<bool> caught_hang_up = false;  // written by a signal handler
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void note_hang_up(int /*signal*/) { caught_hang_up = true; }

}  // namespace

ReloadOnHangUp::ReloadOnHangUp() : had_terminal_(isatty(STDERR_FILENO) != 0) {
  struct sigaction action {};
  action.sa_handler = note_hang_up;
  action.sa_flags = SA_RESTART;
  sigaction(SIGHUP, nullptr, &before_);
  is_ours_ = before_.sa_handler != SIG_IGN;  // as nohup wants it
  if (is_ours_) sigaction(SIGHUP, &action, nullptr);
}

ReloadOnHangUp::~ReloadOnHangUp() {
  if (is_ours_) sigaction(SIGHUP, &before_, nullptr);
}

bool ReloadOnHangUp::caught() noexcept {
  if (!caught_hang_up.exchange(false)) return false;
  if (!had_terminal_ || isatty(STDERR_FILENO) != 0) return true;
  sigaction(SIGHUP, &before_, nullptr);
  std::raise(SIGHUP);
  return false;
}

// ==== meter ====

Meter::Meter(Visibility visibility) : visible_(visibility == Visibility::shown && is_capable_terminal(kStandardError)) {}

Meter::~Meter() {
  if (drawn_) fmt::print(stderr, "\r\x1b[K");
}

void Meter::draw(std::uint64_t now, const std::string& text) {
  constexpr std::uint64_t kEvery = 200'000;
  next_ = now + kEvery;
  drawn_ = true;
  fmt::print(stderr, "\r{}\x1b[K", text);
  std::fflush(stderr);
}

// ==== ticker ====

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

double Ticker::lateness(double fraction) const noexcept {
  const auto wanted = static_cast<std::uint64_t>(fraction * static_cast<double>(ticks_));
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin)
    if ((seen += bins_[bin]) >= wanted && seen > 0) return 10.0 * static_cast<double>(bin + 1);
  return 0;
}

}  // namespace tactus::cli
