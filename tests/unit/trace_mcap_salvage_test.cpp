// SPDX-License-Identifier: Apache-2.0
/// Every byte of a recording damaged in turn: a reader that skips damage ends, and what it hands out was there.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace tactus
