// SPDX-License-Identifier: Apache-2.0
/// The JSON of the Inverse3's service, as far as it is used. Every state answers a command:
///
///   state    {"inverse3": [{"device_id": ID, "state": {"cursor_position": {"x", "y", "z"}, "cursor_velocity": {...}}}, ...]}
///   command  {"inverse3": [{"device_id": ID, "commands": {"set_cursor_force": {"values": {"x", "y", "z"}}}}]}
///
/// in m, m/s and N. Its axes are taken as they are for those of the device frame. Other members are skipped.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>

namespace tactus::device::inverse3 {

inline constexpr std::size_t kMostMessage = 65'536;  ///< [bytes]
inline constexpr std::size_t kMostId = 64;           ///< [bytes]
inline constexpr std::size_t kMostCommand = 256;     ///< [bytes]

struct State {
  std::string id{};  ///< letters, digits, '-' and '_'
  Vec3 position{};   ///< [m]
  Vec3 velocity{};   ///< [m/s] zero where it is not reported
};

/// The device with this id, or the first. Nothing: the message names no such device.
/// err  malformed R-DEV-5: no JSON, deeper than 32, larger than kMostMessage, or an id or a vector that is none; invalid R-DEV-6: a
///      number is not finite, or further than 10 m or 1000 m/s
Result<std::optional<State>> read_state(std::string_view message, std::string_view id);

/// Write a command to `out`.   pre  id as in State; force finite
/// out  its length.   no allocation
std::size_t write_command(char (&out)[kMostCommand], std::string_view id, const Vec3& force) noexcept;

}  // namespace tactus::device::inverse3
