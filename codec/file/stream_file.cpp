// SPDX-License-Identifier: Apache-2.0
#include <tactus/file/stream_file.h>

#include <ostream>

#include <tactus/base/bytes.h>
#include <tactus/base/rule.h>
#include <tactus/packet/substream.h>
#include <tactus/scene/scene_syntax.h>

namespace tactus {
namespace {

// Record types. 128..255 are extensions that any reader may skip.
constexpr std::uint8_t kPacket = 1;
constexpr std::uint8_t kIndex = 2;
constexpr std::uint8_t kTrailer = 3;
constexpr std::uint8_t kNumbered = 4;
constexpr std::uint8_t kFirstExtension = 128;
constexpr std::uint64_t kTrailerPayload = 8;                       // offset of the index
constexpr std::size_t kTrailerSize = 1 + 1 + kTrailerPayload + 4;  // type, size, payload, check value
constexpr std::size_t kRecordExtra = 1 + 10 + 4;                   // at most, around a payload: type, size, check value
constexpr std::uint64_t kMostBeforePacket = 6;                     // tick_delta, number of the substream
constexpr std::uint64_t kMostOfNumber = 9;

constexpr bool is_packet(std::uint8_t type) noexcept { return type == kPacket || type == kNumbered; }

}  // namespace

PacketNumbers::PacketNumbers(const Scene& scene) : has_substream_number_(tactus::has_substream_number(scene)) {
  newest_.resize(has_substream_number_ ? 256 : 1);
}

std::uint64_t* PacketNumbers::of(std::span<const std::uint8_t> packet) noexcept {
  if (!has_substream_number_) return newest_.data();
  return packet.empty() ? nullptr : &newest_[packet[0]];
}

void PacketNumbers::reset() noexcept { newest_.assign(newest_.size(), 0); }

StreamFileWriter::StreamFileWriter(std::ostream& out, const Scene& scene) : out_(&out), numbers_(scene) {}

Result<StreamFileWriter> StreamFileWriter::create(std::ostream& out, const Scene& scene) try {
  TACTUS_TRY(const auto bytes, write_scene(scene));
  StreamFileWriter writer(out, scene);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!out) return fail(Errc::io, "R-FIL-1");
  writer.header_bytes_ = writer.offset_ = bytes.size();
  return writer;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<void> StreamFileWriter::write_record(std::uint8_t type, std::span<const std::uint8_t> payload) {
  record_.clear();
  ByteWriter w(record_);
  w.u8(type);
  w.varint(payload.size());
  w.bytes(payload);
  w.u32(crc32(record_));
  out_->write(reinterpret_cast<const char*>(record_.data()), static_cast<std::streamsize>(record_.size()));
  if (!*out_) return fail(Errc::io, "R-FIL-1");
  offset_ += record_.size();
  return {};
}

Result<void> StreamFileWriter::add(std::int64_t tick, std::uint64_t number, std::span<const std::uint8_t> packet, bool key) try {
  if (tick < tick_ || tick >= kTickLimit) return fail(Errc::invalid_argument, "R-API-5");
  std::uint64_t* const newest = numbers_.of(packet);
  if (newest == nullptr || !is_number(number) || (*newest != 0 && number != *newest + 1))
    return fail(Errc::invalid_argument, "R-API-5");
  const Entry entry{tick, offset_};
  payload_.clear();
  ByteWriter w(payload_);
  w.varint(static_cast<std::uint64_t>(tick - tick_));
  w.bytes(packet);
  record_.reserve(payload_.size() + kRecordExtra);
  if (key) keys_.push_back(entry);
  TACTUS_CHECK(write_record(kPacket, payload_));  // allocates nothing any more
  *newest = number;
  tick_ = tick;
  return {};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<void> StreamFileWriter::finish() try {
  const std::uint64_t index = offset_;
  payload_.clear();
  ByteWriter w(payload_);
  w.varint(keys_.size());
  Entry previous{0, 0};
  for (const Entry& key : keys_) {
    w.varint(static_cast<std::uint64_t>(key.tick - previous.tick));
    w.varint(key.offset - previous.offset);
    previous = key;
  }
  TACTUS_CHECK(write_record(kIndex, payload_));
  payload_.clear();
  w.u64(index);
  TACTUS_CHECK(write_record(kTrailer, payload_));
  out_->flush();
  if (!*out_) return fail(Errc::io, "R-FIL-1");
  return {};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<StreamFileReader> StreamFileReader::open(std::span<const std::uint8_t> file, const DecodeLimits& limits) try {
  TACTUS_TRY(auto parsed, parse_scene(file, limits));
  StreamFileReader reader;
  reader.file_ = file;
  reader.scene_ = std::move(parsed.scene);
  reader.limits_ = limits;
  reader.numbers_ = PacketNumbers(*reader.scene_);
  reader.first_ = reader.position_ = parsed.size;
  return reader;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<StreamFileReader::Record> StreamFileReader::read_record(std::size_t at) const noexcept {
  ByteReader in(file_.subspan(at), at);
  Record record;
  record.type = in.u8();
  const std::uint64_t size = in.varint();
  if (in.overlong()) return fail(Errc::malformed, "R-FIL-6", in.bit_offset());
  if (!in.ok()) return fail(Errc::truncated, "R-FIL-2", in.bit_offset());
  if (record.type < kFirstExtension && (record.type < kPacket || record.type > kNumbered)) {
    return fail(Errc::unsupported, "R-FIL-3", 8 * static_cast<std::uint64_t>(at));
  }
  if (is_packet(record.type) && packet_type_ != 0 && record.type != packet_type_) {
    return fail(Errc::malformed, "R-FIL-9", 8 * static_cast<std::uint64_t>(at));
  }
  const std::uint64_t before = kMostBeforePacket + (record.type == kNumbered ? kMostOfNumber : 0);
  if (is_packet(record.type) && size > std::uint64_t{limits_.packet_bytes} + before) {
    return fail(Errc::limit_exceeded, "R-FIL-4", in.bit_offset());
  }
  if (record.type == kTrailer && size != kTrailerPayload) return fail(Errc::malformed, "R-FIL-6", in.bit_offset());
  record.start = at + in.position();
  record.payload = in.bytes(size);
  const std::size_t covered = in.position();
  const std::uint32_t crc = in.u32();
  if (!in.ok()) return fail(Errc::truncated, "R-FIL-2", in.bit_offset());
  if (crc != crc32(file_.subspan(at, covered))) return fail(Errc::checksum, "R-FIL-5", in.bit_offset() - 32);
  record.end = at + in.position();
  return record;
}

Result<FilePacket> StreamFileReader::read_packet(const Record& record) noexcept {
  ByteReader in(record.payload, record.start);
  const std::uint64_t delta = in.varint();
  if (!in.ok() || delta >= static_cast<std::uint64_t>(kTickLimit - tick_))
    return fail(Errc::malformed, "R-FIL-6", in.bit_offset());
  FilePacket out;
  if (record.type == kNumbered) {
    out.number = in.varint();
    if (!in.ok() || !is_number(out.number)) return fail(Errc::malformed, "R-FIL-6", in.bit_offset());
  }
  out.bytes = in.bytes(in.remaining());
  if (record.type == kPacket) {
    std::uint64_t* const newest = numbers_.of(out.bytes);
    out.number = newest != nullptr ? ++*newest : 1;
  }
  out.tick = tick_ += static_cast<std::int64_t>(delta);
  packet_type_ = record.type;
  position_ = record.end;
  return out;
}

Result<std::optional<FilePacket>> StreamFileReader::next() noexcept {
  while (position_ < file_.size()) {
    const std::uint64_t here = 8 * static_cast<std::uint64_t>(position_);
    if (complete_) return fail(Errc::malformed, "R-FIL-8", here);
    TACTUS_TRY(const Record record, read_record(position_));
    if (is_packet(record.type)) return read_packet(record);
    complete_ = record.type == kTrailer;
    position_ = record.end;
  }
  return std::optional<FilePacket>{};
}

bool StreamFileReader::find_index(std::span<const std::uint8_t>& entries) const noexcept {
  if (file_.size() < first_ + kTrailerSize) return false;
  const auto trailer = read_record(file_.size() - kTrailerSize);
  if (!trailer || trailer->type != kTrailer) return false;
  const std::uint64_t offset = ByteReader(trailer->payload).u64();
  if (offset < first_ || offset >= file_.size()) return false;
  const auto index = read_record(static_cast<std::size_t>(offset));
  if (!index || index->type != kIndex) return false;
  entries = index->payload;
  return true;
}

bool StreamFileReader::seek(std::int64_t tick) noexcept {
  std::span<const std::uint8_t> entries;
  if (tick < 0 || !find_index(entries)) return false;
  ByteReader in(entries);
  std::uint64_t key_tick = 0, key_offset = 0, best_tick = 0, best_offset = 0;
  for (std::uint64_t left = in.varint(); left > 0 && in.ok(); --left) {
    key_tick += in.varint();
    key_offset += in.varint();
    if (!in.ok() || key_tick >= static_cast<std::uint64_t>(kTickLimit) || key_tick > static_cast<std::uint64_t>(tick)) break;
    best_tick = key_tick;
    best_offset = key_offset;
  }
  if (best_offset < first_ || best_offset >= file_.size()) return false;
  const auto record = read_record(static_cast<std::size_t>(best_offset));
  if (!record || !is_packet(record->type)) return false;
  const std::uint64_t delta = ByteReader(record->payload).varint();
  if (delta > best_tick) return false;
  position_ = static_cast<std::size_t>(best_offset);
  tick_ = static_cast<std::int64_t>(best_tick - delta);
  complete_ = false;
  numbers_.reset();
  return true;
}

}  // namespace tactus
