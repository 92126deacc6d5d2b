// SPDX-License-Identifier: Apache-2.0
/// Recordings as ROS 2 programs write them, for tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <tactus/trace/cdr.h>
#include <tactus/trace/mcap_writer.h>
#include <tactus/trace/message_schemas.h>
#include <tactus/trace/messages.h>
#include <tactus/trace/ros_messages.h>
#include "tests/unit/trace_fixture.h"

namespace tactus::ros_bag {

inline Quat about_z(double angle) { return {std::cos(angle / 2), 0, 0, std::sin(angle / 2)}; }

inline void header(CdrWriter& out, std::string_view frame) {
  out.u32(1'700'000'000);  // not used
  out.u32(0);
  out.text(frame);
}

struct Hung {
  std::string_view parent, child;
  Pose pose;
};

inline Bytes transforms(const std::vector<Hung>& all) {
  Bytes message;
  CdrWriter out(message);
  out.u32(static_cast<std::uint32_t>(all.size()));
  for (const Hung& one : all) {
    header(out, one.parent);
    out.text(one.child);
    out.vec3(one.pose.position);
    out.quat(one.pose.rotation);
  }
  return message;
}

inline Bytes transform(const Hung& one) {
  Bytes message;
  CdrWriter out(message);
  header(out, one.parent);
  out.text(one.child);
  out.vec3(one.pose.position);
  out.quat(one.pose.rotation);
  return message;
}

inline Bytes odometry(const Pose& pose, const Twist& twist) {
  Bytes message;
  CdrWriter out(message);
  header(out, "odom");
  out.text("base");
  out.vec3(pose.position);
  out.quat(pose.rotation);
  for (int i = 0; i < 36; ++i) out.f64(i);
  out.vec3(twist.linear);
  out.vec3(twist.angular);
  for (int i = 0; i < 36; ++i) out.f64(-i);
  return message;
}

inline Bytes wrench(std::string_view frame, const Vec3& force) {
  Bytes message;
  CdrWriter out(message);
  header(out, frame);
  out.vec3(force);
  out.vec3({9, 9, 9});
  return message;
}

inline Bytes pose(const Pose& value) {
  Bytes message;
  encode_pose(message, 0, value);
  return message;
}

using Notes = std::vector<std::pair<std::string, std::string>>;

/// A recording that begins on an ordinary day.
class RosBag {
 public:
  RosBag& add(double ms, const std::string& topic, std::string_view schema, const Bytes& message) {
    if (!channels_.contains(topic)) {
      const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
      channels_[topic] = id;
      EXPECT_TRUE(out_.add(mcap::Schema{id, std::string(schema), "ros2msg", ""}));
      EXPECT_TRUE(out_.add(mcap::Channel{id, id, topic, "cdr", {}}));
    }
    const auto time = static_cast<std::uint64_t>(1'700'000'000'000'000'000 + static_cast<std::int64_t>(1e6 * ms));
    out_.add(mcap::Message{channels_[topic], 0, time, time, message});
    return *this;
  }
  RosBag& tf(double ms, const std::vector<Hung>& all) { return add(ms, "/tf", kTransformsSchema, transforms(all)); }
  RosBag& force(double ms, std::string_view frame, const Vec3& force) {
    return add(ms, "/arm/wrench", kWrenchSchema, wrench(frame, force));
  }

  Result<TraceReader> open() {
    EXPECT_TRUE(out_.finish());
    return TraceReader::open(file_.path());
  }
  Result<TraceReader> open(const ReadOptions& options) {
    EXPECT_TRUE(out_.finish());
    auto reader = TraceReader::open(file_.path(), options);
    if (!reader) return tl::unexpected(reader.error().error);
    return std::move(*reader);
  }
  /// All but that of the clock, once everything was read.
  Notes notes() {
    auto reader = open();
    EXPECT_TRUE(reader);
    for (TraceFrame frame; reader && reader->next(frame).value_or(false);) {
    }
    Notes notes;
    for (const ReadNote& note : reader->notes())
      if (!note.what.starts_with("log times are the clock")) notes.emplace_back(note.where, note.what);
    return notes;
  }
  std::string rule() {
    const Reading reading = read_all(open());
    return reading.error ? reading.error->rule : "";
  }

 private:
  TempFile file_;
  mcap::Writer out_ = mcap::Writer::create(file_.path(), "ros2").value();
  std::map<std::string, std::uint16_t> channels_;
};

/// in  count  0: any
inline bool has(const std::vector<ReadNote>& notes, std::string_view where, std::string_view what, std::uint64_t count = 0) {
  return std::ranges::any_of(notes, [&](const ReadNote& note) {
    return note.where == where && note.what == what && (count == 0 || note.count == count);
  });
}
inline bool has(const Notes& notes, std::string_view where, std::string_view what) {
  return std::ranges::find(notes, std::pair(std::string(where), std::string(what))) != notes.end();
}

inline void expect_near(const Vec3& a, const Vec3& b, double off = 1e-9) {
  EXPECT_LT(norm(a - b), off) << a.x << ' ' << a.y << ' ' << a.z;
}

inline Bytes pose_in(std::string_view frame, const Pose& value) {
  Bytes message;
  CdrWriter out(message);
  header(out, frame);
  out.vec3(value.position);
  out.quat(value.rotation);
  return message;
}

inline constexpr std::uint64_t kDay = 1'700'000'000'000'000'000;  // [ns] when a RosBag begins

inline Bytes stamped_pose(double ms, std::string_view frame, const Pose& value) {
  Bytes message;
  CdrWriter out(message);
  const auto stamp = kDay + static_cast<std::uint64_t>(std::llround(1e6 * ms));
  out.u32(static_cast<std::uint32_t>(stamp / 1'000'000'000));
  out.u32(static_cast<std::uint32_t>(stamp % 1'000'000'000));
  out.text(frame);
  out.vec3(value.position);
  out.quat(value.rotation);
  return message;
}

inline Bytes along_x(double x) { return pose_in("world", {{x, 0, 0}, {}}); }
inline const std::string_view kPoseSchema = schema_name(MessageType::pose);

/// Everything that is reported of a location, for people who look at a failure.
inline std::string all_of(const std::vector<ReadNote>& notes) {
  std::string text;
  for (const ReadNote& note : notes) text += note.where + ": " + note.what + " (" + note.first + ")\n";
  return text;
}

}  // namespace tactus::ros_bag
