// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/trace_recorder.h>

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include "tests/property/allocated.h"
#include "tests/unit/trace_fixture.h"

namespace tactus {
namespace {

TraceInfo capture_info() {
  TraceInfo info;
  info.objects.push_back({"cube"});
  info.users.push_back({.name = "hand", .senses = {.velocity = true, .time = true}, .has_servo = true});
  info.capture = TraceCapture{.started = 1'790'000'000'000'000'000, .device = "Falcon 7", .backend = "falcon", .subject = "Zoë"};
  return info;
}

TraceFrame frame_of(const TraceInfo& info, std::int64_t tick) {
  TraceFrame frame;
  frame.tick = tick;
  frame.objects.resize(info.objects.size());
  frame.users.resize(info.users.size());
  if (!frame.users.empty()) {
    frame.users[0].device.position.x = 1e-6 * static_cast<double>(tick);
    frame.users[0].servo = {tick * 3, tick * 5, static_cast<std::uint32_t>(tick % 7), static_cast<std::uint32_t>(tick % 64)};
  }
  for (const TraceDeformable& mesh : info.meshes)
    frame.meshes.push_back({false, std::vector<float>(3 * mesh.rest.vertices.size())});
  return frame;
}

class Recorder : public ::testing::Test {
 protected:
  TempFile file;
  const std::string path = file.path();
};

TEST_F(Recorder, WhatWasOfferedIsRead) {
  const TraceInfo info = capture_info();
  auto recorder = TraceRecorder::create(path, info, frame_of(info, 0)).value();
  for (std::int64_t tick = 0; tick < 3000; ++tick) ASSERT_TRUE(recorder.offer(frame_of(info, tick)));
  ASSERT_TRUE(recorder.finish());
  auto reader = TraceReader::open(path).value();
  EXPECT_EQ(reader.info().capture, info.capture);
  EXPECT_EQ(reader.info().users, info.users);
  TraceFrame frame;
  for (std::int64_t tick = 0; tick < 3000; ++tick) {
    ASSERT_TRUE(reader.next(frame).value());
    ASSERT_EQ(frame.tick, tick);
    ASSERT_EQ(frame.users[0].servo, frame_of(info, tick).users[0].servo);
  }
  EXPECT_FALSE(reader.next(frame).value());
}

TEST_F(Recorder, MarkersStandAtATickOnce) {
  const TraceInfo info = capture_info();
  auto recorder = TraceRecorder::create(path, info, frame_of(info, 0)).value();
  recorder.mark("begin");
  recorder.mark("é");
  recorder.mark(std::string(254, 'a') + "é");  // cut before the character that does not fit
  for (std::int64_t tick = 0; tick < 100; ++tick) recorder.offer(frame_of(info, tick));
  ASSERT_TRUE(recorder.finish());
  auto reader = TraceReader::open(path).value();
  TraceFrame frame;
  std::vector<std::string> markers;
  while (reader.next(frame).value())
    if (!frame.marker.empty()) markers.push_back(frame.marker);
  ASSERT_EQ(markers.size(), 1U);
  EXPECT_EQ(markers[0], "begin; é; " + std::string(254, 'a'));
}

TEST_F(Recorder, AFullRingLosesTicksAndSaysHowMany) {
  const TraceInfo info = capture_info();
  auto recorder = TraceRecorder::create(path, info, frame_of(info, 0), {.frames = 2}).value();
  std::uint64_t refused = 0;
  for (std::int64_t tick = 0; tick < 2000; ++tick) refused += recorder.offer(frame_of(info, tick)) ? 0U : 1U;
  ASSERT_TRUE(recorder.finish());
  EXPECT_GT(refused, 0U);
  EXPECT_EQ(recorder.status().lost, refused);
  auto reader = TraceReader::open(path).value();
  TraceFrame frame;
  std::uint64_t read = 0;
  while (reader.next(frame).value()) ++read;
  EXPECT_EQ(read + refused, 2000U);
}

TEST_F(Recorder, AShapeOfALostTickGoesWithTheNext) {
  TraceInfo info = capture_info();
  info.meshes.push_back({"sheet", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}});
  TraceFrame frame = frame_of(info, 0);
  auto recorder = TraceRecorder::create(path, info, frame, {.frames = 2}).value();
  std::int64_t tick = 0;
  do {
    frame.tick = tick++;
  } while (recorder.offer(frame));
  frame.tick = tick++;
  frame.meshes[0].updated = true;
  frame.meshes[0].displacements[0] = 0.25F;
  const bool was_lost = !recorder.offer(frame);
  frame.meshes[0].updated = false;
  do {
    frame.tick = tick++;
  } while (!recorder.offer(frame));
  ASSERT_TRUE(recorder.finish());
  auto reader = TraceReader::open(path).value();
  TraceFrame read;
  while (reader.next(read).value()) {
  }
  EXPECT_EQ(read.meshes[0].displacements[0], 0.25F) << was_lost;
}

TEST_F(Recorder, AFullDiskEndsTheTraceAtAWholeChunk) {
  const TraceInfo info = capture_info();
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto ignored = signal(SIGXFSZ, SIG_IGN);
  const rlimit small{100'000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  auto recorder = TraceRecorder::create(path, info, frame_of(info, 0)).value();
  std::int64_t tick = 0;
  while (!recorder.status().error && tick < 1'000'000) {
    recorder.offer(frame_of(info, tick++));
    if (tick % 1000 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const auto finished = recorder.finish();
  setrlimit(RLIMIT_FSIZE, &before);
  (void)signal(SIGXFSZ, ignored);
  ASSERT_FALSE(finished);
  EXPECT_STREQ(finished.error().rule, "R-TRC-1");
  auto reader = TraceReader::open(path).value();
  TraceFrame frame;
  std::int64_t last = -1;
  while (reader.next(frame).value()) last = frame.tick;
  EXPECT_TRUE(reader.cut_short());
  EXPECT_GE(last, recorder.status().last_written - 100) << "at most a chunk of 80 ms is missing";
}

TEST_F(Recorder, ReportsThatFindNoRoomMakeATickALostOne) {
  TraceInfo info = capture_info();
  info.users[0].report_descriptor.emplace();
  auto recorder = TraceRecorder::create(path, info, frame_of(info, 0)).value();
  TraceFrame frame = frame_of(info, 0);
  frame.users[0].reports = {std::vector<std::uint32_t>(kMostReports, 1), std::vector<std::uint8_t>(kMostReports)};
  EXPECT_TRUE(recorder.offer(frame));
  frame.tick = 1;
  frame.users[0].reports = {std::vector<std::uint32_t>(kMostReports + 1, 1), std::vector<std::uint8_t>(kMostReports + 1)};
  EXPECT_FALSE(recorder.offer(frame));
  frame.users[0].reports = {{kMostReportBytes + 1}, std::vector<std::uint8_t>(kMostReportBytes + 1)};
  EXPECT_FALSE(recorder.offer(frame));
  EXPECT_EQ(recorder.status().lost, 2u);
  EXPECT_TRUE(recorder.finish());
}

TEST_F(Recorder, OfferAllocatesNothing) {
  TraceInfo info = capture_info();
  info.users[0].report_descriptor.emplace();
  auto recorder = TraceRecorder::create(path, info, frame_of(info, 0)).value();
  TraceFrame frame = frame_of(info, 0);
  frame.users[0].reports = {{1, 2}, {1, 2, 3}};
  struct Offering {
    std::uint64_t bytes;
    bool taken;
  };
  std::vector<Offering> offerings;
  offerings.reserve(100);
  ASSERT_TRUE(recorder.finish());  // the writing thread, which allocates, has ended
  for (std::int64_t tick = 0; tick < 100; ++tick) {
    frame.tick = tick;
    const std::uint64_t before = testing::allocated_bytes();
    const bool taken = recorder.offer(frame);
    offerings.push_back({testing::allocated_bytes() - before, taken});
  }
  for (const Offering& offering : offerings) EXPECT_TRUE(offering.taken && offering.bytes == 0);
}

TEST_F(Recorder, WrongOptionsAndFramesAreRefused) {
  const TraceInfo info = capture_info();
  EXPECT_STREQ(TraceRecorder::create(path, info, frame_of(info, 0), {.frames = 1}).error().rule, "R-API-4");
  EXPECT_STREQ(TraceRecorder::create(path, info, TraceFrame{}).error().rule, "R-API-5");
  EXPECT_STREQ(TraceRecorder::create(path, info, frame_of(info, 0), {.chunk_time = 0}).error().rule, "R-TRC-17");
  TraceInfo bad = info;
  bad.capture->subject = "\xff";
  EXPECT_STREQ(TraceRecorder::create(path, bad, frame_of(info, 0)).error().rule, "R-TRC-11");
}

}  // namespace
}  // namespace tactus
