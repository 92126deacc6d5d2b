// SPDX-License-Identifier: Apache-2.0
/// Records of the MCAP container, major version 0 (mcap.dev/spec). Integers little-endian, times in nanoseconds, strings UTF-8.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace tactus::mcap {

enum class Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0A,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline constexpr std::size_t kRecordPrefix = 1 + 8;  ///< opcode and content length in front of every record
inline constexpr std::size_t kFooterContent = 8 + 8 + 4;

using TextMap = std::map<std::string, std::string>;

struct Schema {
  std::uint16_t id = 0;
  std::string name, encoding, data;
  friend bool operator==(const Schema&, const Schema&) = default;
};

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;  ///< 0: none
  std::string topic, message_encoding;
  TextMap metadata;
  friend bool operator==(const Channel&, const Channel&) = default;
};

struct Message {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0, publish_time = 0;
  std::span<const std::uint8_t> data;
};

struct Attachment {
  std::uint64_t log_time = 0, create_time = 0;
  std::string name, media_type;
  std::span<const std::uint8_t> data;
};

struct Metadata {
  std::string name;
  TextMap entries;
};

struct Statistics {
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0, attachment_count = 0, metadata_count = 0, chunk_count = 0;
  std::uint64_t message_start_time = 0, message_end_time = 0;
  std::map<std::uint16_t, std::uint64_t> channel_message_counts;
};

}  // namespace tactus::mcap
