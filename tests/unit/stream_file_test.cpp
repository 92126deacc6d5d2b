// SPDX-License-Identifier: Apache-2.0
/// Files of packets.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/file/stream_file.h>
#include <tactus/tactus.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;

SharedScene one_object() {
  SceneSpec spec;
  spec.objects.resize(1);
  spec.objects[0].name = "cube";
  return Scene::create(std::move(spec)).value();
}

/// Packets of i bytes of value i at tick 10 i; every third is a key packet.
Bytes sample_file(std::size_t packets, bool finish = true) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *one_object()).value();
  for (std::size_t i = 1; i <= packets; ++i) {
    EXPECT_TRUE(writer.add(static_cast<std::int64_t>(10 * i), i, Bytes(i, static_cast<std::uint8_t>(i)), i % 3 == 1));
  }
  EXPECT_TRUE(!finish || writer.finish());
  const std::string text = out.str();
  return {text.begin(), text.end()};
}

TEST(StreamFile, PacketsComeBackWithTheirTicks) {
  const Bytes file = sample_file(7);
  auto reader = StreamFileReader::open(file).value();
  for (std::size_t i = 1; i <= 7; ++i) {
    const auto packet = reader.next().value();
    ASSERT_TRUE(packet);
    EXPECT_EQ(packet->tick, static_cast<std::int64_t>(10 * i));
    EXPECT_EQ(packet->number, i);
    EXPECT_EQ(Bytes(packet->bytes.begin(), packet->bytes.end()), Bytes(i, static_cast<std::uint8_t>(i)));
  }
  EXPECT_FALSE(reader.next().value());
  EXPECT_TRUE(reader.complete());
}

TEST(StreamFile, AFileWithoutItsEndIsReadableAndSaysSo) {
  const Bytes file = sample_file(4, false);
  auto reader = StreamFileReader::open(file).value();
  int packets = 0;
  while (reader.next().value()) ++packets;
  EXPECT_EQ(packets, 4);
  EXPECT_FALSE(reader.complete());
  EXPECT_FALSE(reader.seek(40)) << "no index, no seek";
}

TEST(StreamFile, SeekFindsTheLastKeyPacketAtOrBefore) {
  const Bytes file = sample_file(9);  // keys at ticks 10, 40, 70
  auto reader = StreamFileReader::open(file).value();
  for (const auto& [tick, expected] : {std::pair{10, 10}, {39, 10}, {40, 40}, {69, 40}, {90, 70}, {100000, 70}}) {
    ASSERT_TRUE(reader.seek(tick));
    const FilePacket packet = *reader.next().value();
    EXPECT_EQ(packet.tick, expected);
    EXPECT_EQ(packet.number, 1u) << "counted from there";
  }
  EXPECT_TRUE(reader.seek(45));
  std::int64_t last = 0;
  while (const auto packet = reader.next().value()) last = packet->tick;
  EXPECT_EQ(last, 90) << "reading goes on to the end from there";
  EXPECT_FALSE(reader.seek(9));
  EXPECT_FALSE(reader.seek(-1));
}

TEST(StreamFile, DamageIsNamedAndTheReaderStays) {
  const Bytes file = sample_file(3);
  const auto header_size = static_cast<std::size_t>(StreamFileReader::open(file).value().position());
  Bytes damaged = file;
  damaged[header_size + 4] ^= 1;  // inside the first packet
  auto reader = StreamFileReader::open(damaged).value();
  const auto packet = reader.next();
  ASSERT_FALSE(packet);
  EXPECT_EQ(packet.error().code, Errc::checksum);
  EXPECT_STREQ(packet.error().rule, "R-FIL-5");
  EXPECT_EQ(reader.position(), header_size);

  damaged = file;
  damaged[header_size] = 77;
  EXPECT_STREQ(StreamFileReader::open(damaged).value().next().error().rule, "R-FIL-3");

  damaged = file;
  damaged.push_back(1);
  auto trailing = StreamFileReader::open(damaged).value();
  while (trailing.next().value_or(std::nullopt)) {
  }
  EXPECT_STREQ(trailing.next().error().rule, "R-FIL-8");
}

TEST(StreamFile, EveryCutGivesAWholePrefixOrTruncated) {
  const Bytes file = sample_file(5);
  const auto header_size = static_cast<std::size_t>(StreamFileReader::open(file).value().position());
  for (std::size_t size = header_size; size < file.size(); ++size) {
    auto reader = StreamFileReader::open(std::span(file).first(size)).value();
    for (;;) {
      const auto packet = reader.next();
      if (!packet) {
        EXPECT_EQ(packet.error().code, Errc::truncated);
        break;
      }
      if (!*packet) break;
    }
    EXPECT_FALSE(reader.complete());
  }
}

TEST(StreamFile, MayBeginAtAnyNumber) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *one_object()).value();
  EXPECT_STREQ(writer.add(5, 0, Bytes{1}, false).error().rule, "R-API-5");
  EXPECT_STREQ(writer.add(5, std::uint64_t{1} << 62, Bytes{1}, false).error().rule, "R-API-5");
  EXPECT_TRUE(writer.add(5, 700, Bytes{1}, false));
  EXPECT_STREQ(writer.add(6, 702, Bytes{1}, false).error().rule, "R-API-5");
  EXPECT_TRUE(writer.add(6, 701, Bytes{1}, false));
}

TEST(StreamFile, WriterRefusesFallingTicksAndOtherNumbersThanTheNext) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *one_object()).value();
  const auto rule = [&](std::int64_t tick, std::uint64_t number) {
    const std::uint64_t before = writer.bytes();
    const auto added = writer.add(tick, number, Bytes{1}, false);
    EXPECT_EQ(writer.bytes() > before, added.has_value());
    return added ? "" : added.error().rule;
  };
  EXPECT_STREQ(rule(5, 1), "");
  EXPECT_STREQ(rule(5, 2), "");
  EXPECT_STREQ(rule(4, 3), "R-API-5");
  EXPECT_STREQ(rule(6, 2), "R-API-5");
  EXPECT_STREQ(rule(6, 4), "R-API-5");
  EXPECT_STREQ(rule(6, 3), "") << "what was refused does not count";
}

/// Each substream counts its own packets, whatever is in them.
TEST(StreamFile, CountsThePacketsOfEachSubstream) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *testing::scene_of_sheets(2, Dof::all)).value();
  const std::vector<std::pair<std::uint8_t, std::uint64_t>> packets{{0, 1}, {1, 1}, {0, 2}, {2, 1},
                                                                    {1, 2}, {0, 3}, {0, 4}, {2, 2}};
  for (const auto& [substream, number] : packets) ASSERT_TRUE(writer.add(1, number, Bytes{substream, 0xff}, false));
  ASSERT_TRUE(writer.finish());
  const std::string text = out.str();
  const Bytes file(text.begin(), text.end());
  auto reader = StreamFileReader::open(file).value();
  auto receiver = Receiver::create(reader.scene(), {.replica = {}, .limits = {.packet_bytes = 0}}).value();
  for (const auto& [substream, number] : packets) {
    const FilePacket packet = *reader.next().value();
    EXPECT_EQ(packet.bytes[0], substream);
    EXPECT_EQ(packet.number, number);
    EXPECT_STREQ(receiver.push(packet.number, packet.bytes).error().rule, "R-PKT-1") << "those that are refused count, too";
  }
}

/// A file whose records are made by hand.
class FileByHand {
 public:
  explicit FileByHand(const Scene& scene) : bytes_(write_scene(scene).value()) {}
  FileByHand& record(std::uint8_t type, const Bytes& payload) {
    Bytes out{type};
    ByteWriter w(out);
    w.varint(payload.size());
    w.bytes(payload);
    w.u32(crc32(out));
    bytes_.insert(bytes_.end(), out.begin(), out.end());
    return *this;
  }
  FileByHand& packet(std::uint64_t tick_delta, const Bytes& packet) {
    Bytes out;
    ByteWriter w(out);
    w.varint(tick_delta);
    w.bytes(packet);
    return record(1, out);
  }
  FileByHand& numbered(std::uint64_t tick_delta, std::uint64_t number, const Bytes& packet) {
    Bytes out;
    ByteWriter w(out);
    w.varint(tick_delta);
    w.varint(number);
    w.bytes(packet);
    return record(4, out);
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

/// The rule that ends a file, or nothing.   out  numbers of the packets before
std::string_view ends_with(const FileByHand& file, std::vector<std::uint64_t>& numbers, const DecodeLimits& limits = {}) {
  auto reader = StreamFileReader::open(file.bytes(), limits).value();
  for (numbers.clear();;) {
    const auto packet = reader.next();
    if (!packet) {
      const std::uint64_t at = reader.position();
      EXPECT_FALSE(reader.next());
      EXPECT_EQ(reader.position(), at);
      return packet.error().rule;
    }
    if (!*packet) return {};
    numbers.push_back((*packet)->number);
  }
}

TEST(StreamFile, NumberedRecordsNameTheirNumbers) {
  using Numbers = std::vector<std::uint64_t>;
  constexpr std::uint64_t kLimit = std::uint64_t{1} << 62;
  const Bytes five(5, 1);
  const auto file = [&](std::uint64_t number) {
    return FileByHand(*one_object()).numbered(3, 70, five).numbered(0, 9, five).record(128, five).numbered(2, number, five);
  };
  Numbers numbers;
  EXPECT_EQ(ends_with(file(kLimit - 1), numbers), "");
  EXPECT_EQ(numbers, (Numbers{70, 9, kLimit - 1}));
  for (const std::uint64_t number : {std::uint64_t{0}, kLimit, ~std::uint64_t{0}}) {
    EXPECT_EQ(ends_with(file(number), numbers), "R-FIL-6") << number;
    EXPECT_EQ(numbers, (Numbers{70, 9}));
  }
  EXPECT_EQ(ends_with(FileByHand(*one_object()).record(4, {1}), numbers), "R-FIL-6") << "no number";
  EXPECT_EQ(ends_with(FileByHand(*one_object()).record(4, {1, 0x80}), numbers), "R-FIL-6") << "half of one";
  EXPECT_EQ(ends_with(FileByHand(*one_object()).record(5, {1, 1}), numbers), "R-FIL-3") << "there is no such type";
}

/// Also before what is wrong inside the record is seen.
TEST(StreamFile, RecordsOfPacketsAreAllOfOneType) {
  const Bytes five(5, 1);
  std::vector<std::uint64_t> numbers;
  EXPECT_EQ(ends_with(FileByHand(*one_object()).packet(1, five).numbered(1, 2, five), numbers), "R-FIL-9");
  EXPECT_EQ(numbers.size(), 1u);
  EXPECT_EQ(ends_with(FileByHand(*one_object()).numbered(1, 2, five).record(128, five).packet(1, five), numbers), "R-FIL-9");
  EXPECT_EQ(numbers.size(), 1u);
  EXPECT_EQ(ends_with(FileByHand(*one_object()).packet(1, five).record(4, {}), numbers), "R-FIL-9");
  EXPECT_EQ(ends_with(FileByHand(*one_object()).packet(1, five).record(4, Bytes(500)), numbers, {.packet_bytes = 8}), "R-FIL-9");
}

TEST(StreamFile, RecordsHaveTheLimitOfPacketsAndWhatIsBefore) {
  std::vector<std::uint64_t> numbers;
  const DecodeLimits limits{.packet_bytes = 100};
  for (const auto& [type, before] : {std::pair{std::uint8_t{1}, 6u}, {std::uint8_t{4}, 15u}}) {
    EXPECT_EQ(ends_with(FileByHand(*one_object()).record(type, Bytes(100 + before, 1)), numbers, limits), "");
    EXPECT_EQ(ends_with(FileByHand(*one_object()).record(type, Bytes(101 + before, 1)), numbers, limits), "R-FIL-4");
  }
}

TEST(StreamFile, AFullDiskIsAnError) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *one_object()).value();
  out.setstate(std::ios::badbit);
  EXPECT_EQ(writer.add(1, 1, Bytes{1}, false).error().code, Errc::io);
}

}  // namespace
}  // namespace tactus
