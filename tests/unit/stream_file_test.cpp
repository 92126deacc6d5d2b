// SPDX-License-Identifier: Apache-2.0
#include <tactus/file/stream_file.h>

#include <gtest/gtest.h>

#include <sstream>

namespace tactus {
namespace {


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
    EXPECT_TRUE(writer.add(static_cast<std::int64_t>(10 * i), Bytes(i, static_cast<std::uint8_t>(i)), i % 3 == 1));
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
    EXPECT_EQ(reader.next().value()->tick, expected);
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

TEST(StreamFile, WriterRefusesFallingTicks) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *one_object()).value();
  EXPECT_TRUE(writer.add(5, Bytes{1}, false));
  EXPECT_TRUE(writer.add(5, Bytes{1}, false));
  const auto result = writer.add(4, Bytes{1}, false);
  ASSERT_FALSE(result);
  EXPECT_STREQ(result.error().rule, "R-API-5");
}

TEST(StreamFile, AFullDiskIsAnError) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *one_object()).value();
  out.setstate(std::ios::badbit);
  EXPECT_EQ(writer.add(1, Bytes{1}, false).error().code, Errc::io);
}

}  // namespace
}  // namespace tactus
