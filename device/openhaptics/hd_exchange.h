// SPDX-License-Identifier: Apache-2.0
/// Samples and forces between the runtime's thread, which calls us 1000 times per second, and the thread that reads and writes the
/// device. No call locks or allocates; the runtime's thread never waits.
#pragma once

#include <semaphore.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <tactus/device/device.h>

namespace tactus::device::openhaptics {

/// One sample as the runtime tells it.
struct RawSample {
  std::array<double, 3> position{};    ///< [mm]
  std::array<double, 3> velocity{};    ///< [mm/s]
  std::array<double, 16> transform{};  ///< column by column
  std::uint32_t buttons = 0;
  Time taken = 0;
};

/// Samples from the runtime's thread to the reader's, each handed out once and in order; the oldest are lost when nobody reads.
class SampleRing {
 public:
  SampleRing() noexcept { sem_init(&posted_, 0, 0); }
  ~SampleRing() { sem_destroy(&posted_); }
  SampleRing(const SampleRing&) = delete;
  SampleRing& operator=(const SampleRing&) = delete;

  void put(const RawSample& sample) noexcept;
  struct Taken {
    RawSample sample{};
    std::uint32_t lost = 0;  ///< before this one
  };
  /// Wait for the next one until `deadline`; nothing: it did not come.
  std::optional<Taken> take(Time deadline) noexcept;
  /// No more will come: take() waits no longer.
  void end() noexcept {
    if (!has_ended_.exchange(true)) sem_post(&posted_);
  }

  static constexpr std::uint64_t kSlots = 1024;  // a second: a machine may stand still for long

 private:
  static constexpr std::size_t kNumbers = 3 + 3 + 16;
  struct Slot {
    std::array<std::atomic<double>, kNumbers> numbers{};
    std::atomic<std::uint32_t> buttons{0};
    std::atomic<Time> taken{0};
  };
  RawSample copy(const Slot& slot) const noexcept;

  std::array<Slot, kSlots> slots_;
  std::atomic<std::uint64_t> begun_{0}, put_{0};  // samples
  std::atomic<bool> has_ended_{false};
  std::uint64_t read_ = 0;  // of the reader
  sem_t posted_{};
};

/// The newest force, from the writer's thread to the runtime's, and what becomes of it when no new one comes: after 10 ms it fades, after
/// 20 ms it is gone.
class ForceBox {
 public:
  void put(const Vec3& force, Time now) noexcept;  ///< ends a halt
  void halt() noexcept { is_halted_.store(true, std::memory_order_release); }
  /// What to exert now.
  Vec3 get(Time now) noexcept;

 private:
  std::atomic<std::uint32_t> version_{0};  // odd: being written
  std::array<std::atomic<double>, 3> force_{};
  std::atomic<Time> time_{0};
  std::atomic<bool> is_halted_{false};
  Vec3 seen_{};  // by the runtime's thread
  Time seen_time_ = 0;
};

}  // namespace tactus::device::openhaptics
