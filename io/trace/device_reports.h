// SPDX-License-Identifier: Apache-2.0
/// Input reports of a device that nobody here interprets, as it sent them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactus {

struct DeviceReports {
  std::vector<std::uint32_t> sizes{};  ///< [bytes] of each, above 0, the oldest first
  std::vector<std::uint8_t> bytes{};   ///< one report behind the other; each begins with its number, if the device numbers them
  friend bool operator==(const DeviceReports&, const DeviceReports&) = default;
};

/// Of one tick of a capture, so that it needs no allocation. What comes beyond waits in the device for the next tick.
inline constexpr std::size_t kMostReports = 64, kMostReportBytes = 8192;

/// The sizes are those of the bytes.
bool is_valid(const DeviceReports& reports) noexcept;
/// Room for a tick.
void reserve(DeviceReports& reports);

/// Two lower-case digits each.
std::string hex_of(std::span<const std::uint8_t> bytes);
/// None: there are other characters, or half a byte.
std::optional<std::vector<std::uint8_t>> bytes_of_hex(std::string_view text);

}  // namespace tactus
