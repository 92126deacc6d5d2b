// SPDX-License-Identifier: Apache-2.0
/// Sections of a stream file, for whoever damages streams on purpose: with its check value repaired, damage reaches the code behind it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/bytes.h>

namespace tactus::testing {

/// The header or a record: from `begin`, its fields before the payload, the payload, then four bytes of check value.
struct Section {
  std::size_t begin = 0, payload = 0, end = 0;  ///< end: of the payload
};
inline constexpr std::size_t kCheckBytes = 4;

/// As far as the lengths lead.
inline std::vector<Section> sections_of(std::span<const std::uint8_t> file) {
  constexpr std::size_t kBeforeBodySize = 8;
  std::vector<Section> out;
  for (std::size_t at = 0; at < file.size();) {
    ByteReader in(file.subspan(at));
    in.bytes(at == 0 ? kBeforeBodySize : 1);
    const std::uint64_t size = at == 0 ? in.u32() : in.varint();
    const std::size_t payload = at + in.position();
    in.bytes(size);
    in.bytes(kCheckBytes);
    if (!in.ok()) break;
    out.push_back({at, payload, payload + static_cast<std::size_t>(size)});
    at += in.position();
  }
  return out;
}

/// Makes the check value of every section right.
inline void repair(std::span<std::uint8_t> file) {
  for (const Section& section : sections_of(file)) {
    const std::uint32_t crc = crc32(file.subspan(section.begin, section.end - section.begin));
    for (std::size_t i = 0; i < kCheckBytes; ++i) file[section.end + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  }
}

/// The file with another payload in one section, whose length then says so. Its check value is wrong until repair().
inline std::vector<std::uint8_t> with_payload(std::span<const std::uint8_t> file, const Section& section,
                                              std::span<const std::uint8_t> payload) {
  const bool is_header = section.begin == 0;
  const std::size_t length_at = is_header ? section.payload - 4 : section.begin + 1;
  std::vector<std::uint8_t> out(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(length_at));
  ByteWriter w(out);
  if (is_header) w.u32(static_cast<std::uint32_t>(payload.size()));
  else w.varint(payload.size());
  w.bytes(payload);
  w.bytes(file.subspan(section.end));
  return out;
}

}  // namespace tactus::testing
