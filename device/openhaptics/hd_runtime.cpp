// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/openhaptics/hd_runtime.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/device/shared_library.h>

namespace tactus::device::openhaptics {

// ==== hd runtime ====

namespace {

constexpr const char* kLibrary = "libHD.so";

tl::unexpected<Diagnostic> refuse(const std::string& path, std::string detail, std::string remedy) {
  return tl::unexpected(Diagnostic{.error = fail(Errc::unsupported, "R-DEV-3").value(),
                                   .file = path,
                                   .detail = std::move(detail),
                                   .remedy = std::move(remedy)});
}

}  // namespace

tl::expected<Runtime, Diagnostic> Runtime::load(const std::string& path) {
  const std::string name = path.empty() ? kLibrary : path;
  auto library = SharedLibrary::load(name);
  if (!library)
    return refuse(
        name, library.error(),
        "install the vendor's runtime (OpenHaptics and the driver of the device), or name the library with --tune runtime=FILE");
  Runtime runtime;
  library->find("hdInitDevice", runtime.init_device);
  library->find("hdDisableDevice", runtime.disable_device);
  library->find("hdMakeCurrentDevice", runtime.make_current_device);
  library->find("hdBeginFrame", runtime.begin_frame);
  library->find("hdEndFrame", runtime.end_frame);
  library->find("hdEnable", runtime.enable);
  library->find("hdGetDoublev", runtime.get_doubles);
  library->find("hdGetIntegerv", runtime.get_integers);
  library->find("hdGetString", runtime.get_string);
  library->find("hdSetDoublev", runtime.set_doubles);
  library->find("hdStartScheduler", runtime.start_scheduler);
  library->find("hdStopScheduler", runtime.stop_scheduler);
  library->find("hdScheduleAsynchronous", runtime.schedule);
  library->find("hdUnschedule", runtime.unschedule);
  library->find("hdGetError", runtime.get_error);
  library->find("hdGetErrorString", runtime.error_text);
  if (library->missing() != nullptr)
    return refuse(name, std::string("no function ") + library->missing(), "take a runtime of OpenHaptics 3.4 or newer");
  return runtime;
}

// ==== hd exchange ====

namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;
constexpr Time kFresh = 10 * kMillisecond, kGone = 20 * kMillisecond;
constexpr Time kSecond = 1000 * kMillisecond;

}  // namespace

/// The reader trusts a slot only if, afterwards, nobody has begun to write it again.
void SampleRing::put(const RawSample& sample) noexcept {
  const std::uint64_t here = put_.load(kRelaxed);
  begun_.store(here + 1, kRelaxed);
  std::atomic_thread_fence(std::memory_order_release);
  Slot& slot = slots_[here % kSlots];
  auto number = slot.numbers.begin();
  const auto store = [&number](double value) { (number++)->store(value, kRelaxed); };
  std::ranges::for_each(sample.position, store);
  std::ranges::for_each(sample.velocity, store);
  std::ranges::for_each(sample.transform, store);
  slot.buttons.store(sample.buttons, kRelaxed);
  slot.taken.store(sample.taken, kRelaxed);
  put_.store(here + 1, std::memory_order_release);
  int waiting = 0;
  sem_getvalue(&posted_, &waiting);
  if (waiting < 1) sem_post(&posted_);
}

RawSample SampleRing::copy(const Slot& slot) const noexcept {
  RawSample out;
  auto number = slot.numbers.begin();
  const auto load = [&number](double& value) { value = (number++)->load(kRelaxed); };
  std::ranges::for_each(out.position, load);
  std::ranges::for_each(out.velocity, load);
  std::ranges::for_each(out.transform, load);
  out.buttons = slot.buttons.load(kRelaxed);
  out.taken = slot.taken.load(kRelaxed);
  return out;
}

std::optional<SampleRing::Taken> SampleRing::take(Time deadline) noexcept {
  const timespec until{deadline / kSecond, deadline % kSecond};
  Taken taken;
  for (;;) {
    const std::uint64_t there = put_.load(std::memory_order_acquire);
    if (there == read_) {
      if (has_ended_.load(std::memory_order_acquire)) return std::nullopt;
      const bool is_over = sem_clockwait(&posted_, CLOCK_MONOTONIC, &until) != 0 && errno == ETIMEDOUT;
      if (is_over && put_.load(std::memory_order_acquire) == read_) return std::nullopt;
      continue;
    }
    const std::uint64_t oldest = there > kSlots ? there - kSlots : 0;
    const std::uint64_t from = std::max(read_, oldest);
    taken.sample = copy(slots_[from % kSlots]);
    std::atomic_thread_fence(std::memory_order_acquire);
    taken.lost += static_cast<std::uint32_t>(from - read_);
    read_ = from;
    if (begun_.load(kRelaxed) > from + kSlots) continue;  // it was overwritten meanwhile
    ++read_;
    return taken;
  }
}

void ForceBox::put(const Vec3& force, Time now) noexcept {
  const std::uint32_t version = version_.load(kRelaxed);
  version_.store(version + 1, kRelaxed);
  std::atomic_thread_fence(std::memory_order_release);
  force_[0].store(force.x, kRelaxed);
  force_[1].store(force.y, kRelaxed);
  force_[2].store(force.z, kRelaxed);
  time_.store(now, kRelaxed);
  version_.store(version + 2, std::memory_order_release);
  is_halted_.store(false, std::memory_order_release);
}

Vec3 ForceBox::get(Time now) noexcept {
  const std::uint32_t before = version_.load(std::memory_order_acquire);
  const Vec3 force{force_[0].load(kRelaxed), force_[1].load(kRelaxed), force_[2].load(kRelaxed)};
  const Time time = time_.load(kRelaxed);
  std::atomic_thread_fence(std::memory_order_acquire);
  if (before % 2 == 0 && version_.load(kRelaxed) == before) {  // else the one before counts for another tick
    seen_ = force;
    seen_time_ = time;
  }
  if (is_halted_.load(std::memory_order_acquire)) return {};
  const double left = static_cast<double>(seen_time_ + kGone - now) / static_cast<double>(kGone - kFresh);
  return std::clamp(left, 0.0, 1.0) * seen_;
}

}  // namespace tactus::device::openhaptics
