// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/device_reports.h>

#include <charconv>

namespace tactus {

bool is_valid(const DeviceReports& reports) noexcept {
  std::uint64_t all = 0;
  for (const std::uint32_t size : reports.sizes) {
    if (size == 0) return false;
    all += size;
  }
  return all == reports.bytes.size();
}

void reserve(DeviceReports& reports) {
  reports.sizes.reserve(kMostReports);
  reports.bytes.reserve(kMostReportBytes);
}

std::string hex_of(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) text.append({kDigits[byte >> 4], kDigits[byte & 15]});
  return text;
}

std::optional<std::vector<std::uint8_t>> bytes_of_hex(std::string_view text) {
  if (text.size() % 2 != 0) return std::nullopt;
  std::vector<std::uint8_t> bytes(text.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const char* const begin = text.data() + 2 * i;
    const auto [end, error] = std::from_chars(begin, begin + 2, bytes[i], 16);
    if (error != std::errc() || end != begin + 2) return std::nullopt;
  }
  return bytes;
}

}  // namespace tactus
