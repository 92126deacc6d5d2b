// SPDX-License-Identifier: Apache-2.0
/// Where a HID device puts its axes and buttons (USB "Device Class Definition for HID" 1.11, section 6.2.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/result.h>

namespace tactus::device::hid {

inline constexpr std::size_t kMostDescriptor = 4096;              ///< bytes; the kernel hands out no more
inline constexpr std::uint32_t kMostReport = 4096 * 8;            ///< bits
inline constexpr std::size_t kReportBytes = kMostReport / 8 + 1;  ///< with its id
inline constexpr std::size_t kMostFields = 1024;
inline constexpr std::uint32_t kAxisX = 0x1'0030, kAxisRz = 0x1'0035;  ///< X, Y, Z, Rx, Ry, Rz follow one another
inline constexpr std::uint32_t kButtons = 0x9'0000;                    ///< button n is kButtons + n
inline constexpr unsigned kMostButtons = 32;
inline constexpr std::uint32_t kMultiAxisController = 0x1'0008;

/// An axis or a button of an input report. Usages hold their page in the upper half.
struct Field {
  std::uint32_t usage = 0;                         ///< kAxisX..kAxisRz, or a button from 1 to kMostButtons
  std::uint32_t application = 0;                   ///< usage of the collection around it, such as kMultiAxisController
  std::uint8_t report = 0;                         ///< id, the first byte of its report; 0: reports have none
  std::uint32_t bit = 0;                           ///< where it begins behind the id; the lowest bit comes first
  std::uint8_t size = 0;                           ///< 1..32 bits
  std::int64_t logical_low = 0, logical_high = 0;  ///< what stands in the report; of an axis low < high
  std::int64_t physical_low = 0,
               physical_high = 0;  ///< what that means, times 10^exponent units; as logical, if it is not stated
  std::uint32_t unit = 0;
  std::int8_t exponent = 0;  ///< -8..7

  friend bool operator==(const Field&, const Field&) = default;
};

/// The fields of all input reports, in the order of the descriptor. Constants, arrays and fields of other usages are passed over, and so
/// is what goes beyond the usages that an item names.
/// err  malformed R-DEV-5 an item is cut off or out of order, a collection or a state is not closed or never was open, a limit above is
///      passed, or an axis has no range
/// time O(bytes + bits of its reports)
Result<std::vector<Field>> parse_report_descriptor(std::span<const std::uint8_t> bytes);

/// What a report says of a field; none: it is another report, or too short.   time O(1), no allocation
std::optional<std::int64_t> value_in(std::span<const std::uint8_t> report, const Field& field) noexcept;

}  // namespace tactus::device::hid
