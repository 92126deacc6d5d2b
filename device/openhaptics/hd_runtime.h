// SPDX-License-Identifier: Apache-2.0
/// The vendor's runtime of Touch, Touch X and Phantom devices (HDAPI of OpenHaptics), loaded while this program runs: nothing of it is
/// needed to build. Lengths are in mm, forces in N; the axes are x to the right, y up, z toward the user.
#pragma once

#include <semaphore.h>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include <tactus/base/diagnostic.h>
#include <tactus/device/device.h>

namespace tactus::device::openhaptics {

// ==== hd runtime ====

using Handle = std::uint32_t;
inline constexpr Handle kNoDevice = 0xffffffff;

/// Returned by value, all three fields: a record without the last would be returned in another way.
struct ErrorRecord {
  std::uint32_t code;  ///< 0: none
  std::int32_t internal;
  Handle device;
};

enum class Parameter : std::uint32_t {
  buttons = 0x2000,    // int, a bit per button
  position = 0x2050,   // 3 doubles [mm]
  velocity = 0x2051,   // 3 doubles [mm/s]
  transform = 0x2052,  // 16 doubles, column by column
  serial = 0x2504,     // text
  rate = 0x2600,       // int [Hz]
  max_force = 0x2603,  // double [N]
  force = 0x2700,      // 3 doubles [N]
};
inline constexpr std::uint32_t kForceOutput = 0x4000;  // to enable

using Callback = std::uint32_t (*)(void*);
inline constexpr std::uint32_t kDone = 0, kContinue = 1;  // of a callback

/// A loaded runtime. It stays loaded until the program ends: its threads may outlive what uses it.
struct Runtime {
  Handle (*init_device)(const char* name) = nullptr;  ///< null: the default device
  void (*disable_device)(Handle) = nullptr;
  void (*make_current_device)(Handle) = nullptr;
  void (*begin_frame)(Handle) = nullptr;
  void (*end_frame)(Handle) = nullptr;
  void (*enable)(std::uint32_t) = nullptr;
  void (*get_doubles)(Parameter, double*) = nullptr;
  void (*get_integers)(Parameter, int*) = nullptr;
  const char* (*get_string)(Parameter) = nullptr;
  void (*set_doubles)(Parameter, const double*) = nullptr;
  void (*start_scheduler)() = nullptr;
  void (*stop_scheduler)() = nullptr;
  unsigned long (*schedule)(Callback, void*, unsigned short priority) = nullptr;
  void (*unschedule)(unsigned long) = nullptr;
  ErrorRecord (*get_error)() = nullptr;  ///< the oldest that nobody has seen
  const char* (*error_text)(std::uint32_t) = nullptr;

  /// in   path  the library; empty: libHD.so, where the system looks for libraries
  /// err  unsupported R-DEV-3: it is not there, or lacks a function
  static tl::expected<Runtime, Diagnostic> load(const std::string& path);
};

// ==== hd exchange ====
// Samples and forces between the runtime's thread, which calls us 1000 times per second, and the thread that reads and writes the
// device. No call locks or allocates; the runtime's thread never waits.

/// One sample as the runtime reports it.
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
