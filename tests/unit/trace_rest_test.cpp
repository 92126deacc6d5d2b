// SPDX-License-Identifier: Apache-2.0
// Objects that rest in a trace: io/trace/trace_file.h.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <string>

#include <tactus/trace/mcap_reader.h>
#include "tests/unit/trace_fixture.h"

namespace tactus {
namespace {

/// Which poses and twists are in the file: those that are new.
TEST(Trace, AnObjectThatRestsIsWrittenOnce) {
  Recording recording = make_recording(40);
  const RigidSample rest = recording.frames[0].objects[0];
  std::size_t changes = 1;
  for (std::size_t i = 1; i < recording.frames.size(); ++i) {
    RigidSample& sample = recording.frames[i].objects[0];
    sample = recording.frames[i - 1].objects[0];
    if (i % 10 == 3) sample.pose.position.x = std::nextafter(sample.pose.position.x, 1e9), ++changes;  // the pose alone
    if (i % 10 == 7) sample.velocity.y = std::nextafter(sample.velocity.y, 1e9), ++changes;            // the twist alone
  }
  const TempFile file;
  const Bytes bytes = write_recording(recording, file.path());
  const Reading reading = read_bytes(bytes);
  ASSERT_EQ(reading.frames.size(), recording.frames.size());
  for (std::size_t i = 0; i < reading.frames.size(); ++i) {
    EXPECT_EQ(std::memcmp(&reading.frames[i].objects[0], &recording.frames[i].objects[0], sizeof rest), 0) << i;
    EXPECT_EQ(reading.frames[i].tick, recording.frames[i].tick);
  }
  auto reader = mcap::Reader::open(ByteSource::over_memory(bytes));
  std::map<std::string, std::size_t> count;
  for (auto item = reader->next(); item && *item != mcap::Item::end; item = reader->next())
    if (*item == mcap::Item::message) ++count[reader->channels().at(reader->message().channel_id).topic];
  EXPECT_EQ(changes, 9u);
  const std::string object = "/objects/" + recording.info.objects[0].name;
  EXPECT_EQ(count[object + "/pose"], changes);
  EXPECT_EQ(count[object + "/twist"], changes);
}

/// Who marks what changed gets the same file; who leaves ticks out, too.
TEST(Trace, WhatIsMarkedAsChangedIsAllThatIsLookedAt) {
  for (const std::int64_t stride : {1, 3}) {
    Recording recording = make_recording(60);
    for (std::size_t i = 1; i < recording.frames.size(); ++i) {
      TraceFrame& frame = recording.frames[i];
      const bool moves = i % 4 == 1;
      if (!moves) frame.objects = recording.frames[i - 1].objects;
    }
    Recording marked{recording.info, {}}, silent = marked;
    for (std::size_t i = 0; i < recording.frames.size(); i += static_cast<std::size_t>(stride)) {
      silent.frames.push_back(recording.frames[i]);
      marked.frames.push_back(recording.frames[i]);
      marked.frames.back().changed.emplace();
      for (std::uint32_t k = 0; k < recording.info.objects.size() && i % 4 == 1; ++k) marked.frames.back().changed->push_back(k);
    }
    const TempFile first, second;
    EXPECT_EQ(write_recording(marked, first.path()), write_recording(silent, second.path())) << stride;
  }
}

/// A number that no object has does no harm.
TEST(Trace, AnUnknownObjectThatChangedIsIgnored) {
  Recording recording = make_recording(4);
  Recording marked = recording;
  for (TraceFrame& frame : marked.frames) frame.changed = {{0, 1, 2, 3, 4, 5, 6, 7, 100, 0xffffffff}};
  const TempFile first, second;
  EXPECT_EQ(write_recording(marked, first.path()), write_recording(recording, second.path()));
}

}  // namespace
}  // namespace tactus
