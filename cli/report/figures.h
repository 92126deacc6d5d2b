// SPDX-License-Identifier: Apache-2.0
/// Figures as reports print them.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <string>

#include <tactus/rigid/rigid_state.h>

namespace tactus::cli {

inline constexpr std::array<const char*, 4> kReasons{"request", "heartbeat", "visual", "haptic"};  // index: Reason
inline constexpr std::array<const char*, 3> kLayers{"haptic", "visual", "all"};                    // index: Layer

inline constexpr std::uint64_t kUdpHeader = 28;  // [bytes] IPv4 20, UDP 8

inline std::string percent(double share) {
  if (share == 0 || share == 1) return fmt::format("{:.0f} %", 100 * share);
  return fmt::format("{:.{}f} %", 100 * share, share < 0.0995 || share > 0.995 ? 2 : 1);
}
inline std::string significant(double value, int digits = 3) { return value == 0 ? "0" : fmt::format("{:.{}g}", value, digits); }

inline std::string duration(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.2f} us", 1e6 * seconds);
  return seconds < 1 ? fmt::format("{:.1f} ms", 1e3 * seconds) : fmt::format("{:.2f} s", seconds);
}

inline constexpr std::array<const char*, 6> kDofNames{"x", "y", "z", "rx", "ry", "rz"};
/// Along and about which axes an object can move.
inline std::string dof_text(std::uint8_t dof) {
  if (dof == Dof::none) return "static";
  if (dof == Dof::all) return "all";
  std::string text;
  for (std::size_t i = 0; i < kDofNames.size(); ++i) {
    if (dof >> i & 1u) text += (text.empty() ? "" : " ") + std::string(kDofNames[i]);
  }
  return text;
}

inline double per(double amount, double base) { return base > 0 ? amount / base : 0; }

}  // namespace tactus::cli
