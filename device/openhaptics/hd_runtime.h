// SPDX-License-Identifier: Apache-2.0
/// The vendor's runtime of Touch, Touch X and Phantom devices (HDAPI of OpenHaptics), loaded while this program runs: nothing of it is
/// needed to build. Lengths are in mm, forces in N; the axes are x to the right, y up, z toward the user.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>

#include <tactus/base/diagnostic.h>

namespace tactus::device::openhaptics {

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

}  // namespace tactus::device::openhaptics
