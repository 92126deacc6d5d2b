// SPDX-License-Identifier: Apache-2.0
/// Every byte of a recording damaged in turn: a reader that skips damage ends, and what it hands out was there.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>

#include <tactus/trace/mcap_reader.h>
#include "tests/unit/trace_fixture.h"

namespace tactus {
namespace {

/// Buttons are said when they are new: behind a gap they are those from before it until they change.
std::string without_buttons(TraceFrame frame) {
  for (UserSample& user : frame.users) user.device.buttons = 0;
  return image(frame);
}

std::size_t frames_of(const Bytes& bytes, const std::set<std::string>& known, std::size_t& strange) {
  const TempFile file;
  std::ofstream(file.path(), std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  auto reader = TraceReader::open(file.path(), {.on_damage = OnDamage::skip});
  if (!reader) return 0;
  TraceFrame frame;
  std::size_t count = 0;
  while (reader->next(frame).value_or(false)) {
    ++count;
    strange += known.contains(without_buttons(frame)) ? 0U : 1U;
  }
  return count;
}

TEST(TraceMcapSalvage, DamageAnywhereCostsNoMoreThanItsChunk) {
  const TempFile file;
  Recording recording = make_recording(40);
  const Bytes whole = [&] {
    auto writer = TraceWriter::create(file.path(), recording.info, {.chunk_time = 0.02});
    EXPECT_TRUE(writer);
    for (const TraceFrame& frame : recording.frames) EXPECT_TRUE(writer->write(frame));
    EXPECT_TRUE(writer->finish());
    std::ifstream in(file.path(), std::ios::binary);
    return Bytes{std::istreambuf_iterator<char>(in), {}};
  }();
  std::set<std::string> known;
  for (const TraceFrame& frame : recording.frames) known.insert(without_buttons(frame));
  std::size_t strange = 0;
  ASSERT_EQ(frames_of(whole, known, strange), 40U);
  ASSERT_EQ(strange, 0U);
  const std::string text(whole.begin(), whole.end());
  const std::size_t first = text.find("zstd");
  std::size_t fewest = 40;
  for (std::size_t i = first; i < whole.size(); i += 7) {
    Bytes damaged = whole;
    damaged[i] ^= 0x10;
    const std::size_t count = frames_of(damaged, known, strange);
    EXPECT_TRUE(count >= 29 || count == 0) << i << ": " << count;  // 0: the first chunk holds what is said once
    if (count > 0) fewest = std::min(fewest, count);
  }
  EXPECT_EQ(strange, 0U);
  EXPECT_LT(fewest, 40U);
}

/// Bytes of an MCAP file.
class Raw {
 public:
  template <class T>
  Raw& number(T value) {
    for (std::size_t i = 0; i < sizeof value; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    return *this;
  }
  Raw& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes.insert(bytes.end(), value.begin(), value.end());
    return *this;
  }
  Raw& record(std::uint8_t opcode, const Raw& content) {
    number(opcode).number(std::uint64_t{content.bytes.size()});
    bytes.insert(bytes.end(), content.bytes.begin(), content.bytes.end());
    return *this;
  }
  Raw& message(std::uint16_t channel, std::uint64_t time) {
    return record(5, Raw().number(channel).number(std::uint32_t{0}).number(time).number(time).number(std::uint32_t{7}));
  }
  Bytes bytes;
};

/// What lies in damage and looks like a record by chance is none: a message of another century, a chunk whose lengths do not agree.
TEST(TraceMcapSalvage, WhatOnlyLooksLikeARecordIsLeftOut) {
  constexpr std::uint64_t kNow = 1'700'000'000'000'000'000, kYear = 31'557'600'000'000'000;
  constexpr std::uint64_t kTooLong = 1ull << 60;
  Raw file;
  file.bytes.assign(mcap::kMagic.begin(), mcap::kMagic.end());
  file.record(1, Raw().text("").text("test")).record(3, Raw().number(std::uint16_t{1}).text("a/b").text("").text(""));
  file.record(4, Raw().number(std::uint16_t{1}).number(std::uint16_t{1}).text("/a").text("cdr").text(""));
  file.message(1, kNow);
  file.number(std::uint8_t{5}).number(kTooLong);  // the damage
  file.message(1, kNow + 100 * kYear).message(1, kNow - 40 * kYear).message(9, kNow);
  Raw chunk;
  chunk.number(kNow).number(kNow).number(std::uint64_t{40}).number(std::uint32_t{0}).text("").number(std::uint64_t{39});
  chunk.message(1, kNow + 2);
  file.record(6, chunk);
  file.message(1, kNow + 5);
  const TempFile at;
  std::ofstream(at.path(), std::ios::binary)
      .write(reinterpret_cast<const char*>(file.bytes.data()), static_cast<std::streamsize>(file.bytes.size()));
  auto reader = mcap::Reader::open(files_of(at.path()).value(), OnDamage::skip).value();
  std::vector<std::uint64_t> times;
  for (auto item = reader.next(); item && *item != mcap::Item::end; item = reader.next())
    if (*item == mcap::Item::message) times.push_back(reader.message().log_time);
  EXPECT_EQ(times, (std::vector<std::uint64_t>{kNow, kNow + 2, kNow + 5}));
}

}  // namespace
}  // namespace tactus
