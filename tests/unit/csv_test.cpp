// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/csv.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>

#include <tactus/trace/byte_source.h>
#include <tactus/trace/csv_time.h>
#include <tactus/trace/csv_units.h>
#include "tests/unit/csv_fixture.h"

namespace tactus {
namespace {

const CsvMapping& preset(std::string_view name) {
  const auto& all = csv_presets();
  return std::find_if(all.begin(), all.end(), [&](const CsvPreset& p) { return p.name == name; })->mapping;
}

constexpr std::string_view kTosses =
    "toss,sample,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n"
    "0,0,0.2098741,0.1958426,0.1257335,0.4319948,0.2302759,0.8712987,-0.0345272,-1.047518,-0.8494504,-0.02586917,-3.356067,"
    "-0.7965873,3.893714\n"
    "0,1,0.2028314,0.190134,0.1252054,0.4373504,0.2366988,0.8673623,-0.01951942,-1.045661,-0.8471008,-0.07806063,-3.369837,"
    "-0.7949634,3.893714\n"
    "1,0,0.1921133,0.2176422,0.1463789,0.9094638,-0.1445963,-0.3196285,-0.2231708,-0.818671,-0.7315462,-0.1418329,2.104309,"
    "0.4019124,-2.376132\n";

TEST(Csv, CubeTosses) {
  const Imported outcome = import(kTosses, preset("cube-tosses"));
  ASSERT_EQ(outcome.rule, "");
  EXPECT_EQ(outcome.done.ticks.count(), 3u);
  EXPECT_EQ(outcome.done.segments, 2u);
  EXPECT_EQ(outcome.info.tick_rate, 148u);
  ASSERT_EQ(outcome.info.objects.size(), 1u);
  EXPECT_EQ(outcome.info.objects[0].name, "cube");
  ASSERT_EQ(outcome.frames.size(), 3u);
  EXPECT_EQ(outcome.frames[2].tick, 2);
  EXPECT_EQ(outcome.frames[1].objects[0].pose.position, (Vec3{0.2028314, 0.190134, 0.1252054}));
  EXPECT_EQ(outcome.frames[2].objects[0].pose.rotation, (Quat{0.9094638, -0.1445963, -0.3196285, -0.2231708}));
  EXPECT_EQ(outcome.frames[2].objects[0].velocity, (Vec3{-0.818671, -0.7315462, -0.1418329}));
  const Vec3 body{-3.356067, -0.7965873, 3.893714};  // recorded so; a trace has it in the world frame
  EXPECT_LT(norm(outcome.frames[0].objects[0].angular_velocity - rotate(outcome.frames[0].objects[0].pose.rotation, body)), 1e-6);
  EXPECT_FALSE(outcome.done.angular_velocity.is_off());
}

/// A top that lies on its side, x up to y, and spins about its own z axis with 3 rad/s.
std::string lying_top() {
  std::string text = "x,y,z,qw,qx,qy,qz,wx,wy,wz\n";
  for (int i = 0; i < 20; ++i) {
    const double half = 0.5 * 3.0 * 0.01 * i, s = std::sqrt(0.5);
    const Quat q = Quat{s, s, 0, 0} * Quat{std::cos(half), 0, 0, std::sin(half)};
    std::ostringstream row;
    row.precision(17);
    row << "0,0,0," << q.w << ',' << q.x << ',' << q.y << ',' << q.z << ",0,0,3\n";
    text += row.str();
  }
  return text;
}

CsvMapping top(AngularVelocityFrame frame) {
  CsvMapping mapping = xyz();
  mapping.rotation = {"qw", "qx", "qy", "qz"};
  mapping.angular_velocity = {"wx", "wy", "wz"};
  mapping.angular_velocity_frame = frame;
  return mapping;
}

TEST(Csv, AngularVelocityOfTheBodyFrameIsTurnedIntoTheWorldFrame) {
  const Imported outcome = import(lying_top(), top(AngularVelocityFrame::body));
  ASSERT_EQ(outcome.rule, "");
  for (const TraceFrame& frame : outcome.frames) EXPECT_LT(norm(frame.objects[0].angular_velocity - Vec3{0, -3, 0}), 1e-9);
  EXPECT_EQ(outcome.done.angular_velocity.rows, 19u);
  EXPECT_NEAR(outcome.done.angular_velocity.given, 3, 1e-9);
  EXPECT_LT(outcome.done.angular_velocity.off, 1e-6);
  EXPECT_NEAR(outcome.done.angular_velocity.off_other, std::sqrt(18), 1e-6);
  EXPECT_FALSE(outcome.done.angular_velocity.is_off());
}

TEST(Csv, AngularVelocityInAnotherFrameContradictsTheRotations) {
  const Imported outcome = import(lying_top(), top(AngularVelocityFrame::world));
  ASSERT_EQ(outcome.rule, "");
  EXPECT_EQ(outcome.frames[3].objects[0].angular_velocity, (Vec3{0, 0, 3}));
  EXPECT_TRUE(outcome.done.angular_velocity.is_off());
  EXPECT_LT(outcome.done.angular_velocity.off_other, 1e-6);
}

TEST(Csv, AngularVelocityOfTheBodyFrameNeedsRotations) {
  CsvMapping mapping = top(AngularVelocityFrame::body);
  mapping.rotation = {};
  EXPECT_EQ(import(lying_top(), mapping).rule, "R-CSV-8");
}

TEST(Csv, ZstdInputGivesTheSameTrace) {
  std::string text(kTosses);
  for (int i = 1; i <= 5000; ++i) text += "2," + std::to_string(i) + ",0,0,0,1,0,0,0,0,0,0,0,0," + std::to_string(i) + "\n";
  Compressor compressor;
  const std::span<const std::uint8_t> raw(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  const auto compressed = compressor.compress(raw).value();
  const std::string packed(compressed.begin(), compressed.end());
  const Imported a = import(text, preset("cube-tosses")), b = import(packed, preset("cube-tosses"));
  ASSERT_EQ(a.frames.size(), 5003u);
  ASSERT_EQ(b.frames.size(), 5003u);
  for (std::size_t i = 0; i < a.frames.size(); ++i) ASSERT_EQ(image(a.frames[i]), image(b.frames[i]));
  EXPECT_EQ(import(packed.substr(0, packed.size() - 9), preset("cube-tosses")).rule, "R-CSV-1");
  EXPECT_EQ(import(packed.substr(0, 20), preset("cube-tosses")).rule, "R-CSV-1");
  std::string damaged = packed;
  damaged[5] = static_cast<char>(~damaged[5]);
  damaged[9] = static_cast<char>(~damaged[9]);
  EXPECT_NE(import(damaged, preset("cube-tosses")).rule, "");
}

TEST(Csv, ExportReadsBackToTheSameBits) {
  Recording recording = make_recording(300, 148);
  recording.info.objects[0].name = "a \"cube\", red";
  const TempFile trace, again;
  write_recording(recording, trace.path());
  std::ostringstream text;
  auto reader = TraceReader::open(trace.path());
  ASSERT_TRUE(reader);
  const auto rows = export_csv(*reader, text);
  ASSERT_TRUE(rows);
  EXPECT_EQ(rows->count(), 300u);
  const Imported outcome = import(text.str(), preset("tactus"));
  ASSERT_EQ(outcome.rule, "") << to_string(outcome.error);
  EXPECT_EQ(outcome.info.tick_rate, 148u);
  EXPECT_EQ(outcome.info.users, recording.info.users);
  ASSERT_EQ(outcome.info.objects.size(), 2u);
  EXPECT_EQ(outcome.info.objects[0].name, recording.info.objects[0].name);
  EXPECT_EQ(outcome.info.objects[1].dof, Dof::none);
  ASSERT_EQ(outcome.frames.size(), recording.frames.size());
  for (std::size_t i = 0; i < outcome.frames.size(); ++i) ASSERT_EQ(image(outcome.frames[i]), image(recording.frames[i])) << i;
}

TEST(Csv, AForceThatTheTraceDoesNotKnowHasNoColumns) {
  for (const RecordedForces known : {RecordedForces::rendered, RecordedForces::server}) {
    Recording recording = make_recording(3);
    recording.info.users[0].forces = known;
    for (TraceFrame& frame : recording.frames) {
      UserSample& user = frame.users[0];
      if (known == RecordedForces::rendered) user.server_force = {};
      else user.force = user.server_force;
    }
    const TempFile trace;
    write_recording(recording, trace.path());
    auto reader = TraceReader::open(trace.path());
    std::ostringstream text;
    ASSERT_TRUE(export_csv(*reader, text));
    const std::string names = text.str().substr(0, text.str().find('\n'));
    for (const char axis : {'x', 'y', 'z'}) {
      const auto has = [&](const char* column) { return names.find(std::string(column) + axis) != std::string::npos; };
      EXPECT_EQ(has("/users/left/force_"), known == RecordedForces::rendered);
      EXPECT_EQ(has("/users/left/server_force_"), known == RecordedForces::server);
      EXPECT_TRUE(has("/users/right/force_") && has("/users/right/server_force_"));
    }
    const Imported outcome = import(text.str(), preset("tactus"));
    ASSERT_EQ(outcome.rule, "") << to_string(outcome.error);
    EXPECT_EQ(outcome.info.users, recording.info.users);
    ASSERT_EQ(outcome.frames.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(image(outcome.frames[i]), image(recording.frames[i])) << i;
  }
}

TEST(Csv, AUserHasOneForceAtLeastAndAllOfIt) {
  const auto location = [](std::string_view forces) {
    std::string names = "tick,time_s", row = "0,0";
    for (const char* column : {"contact", "contact_object", "device_x", "device_y", "device_z", "point_x", "point_y", "point_z",
                               "normal_x", "normal_y", "normal_z", "stiffness"}) {
      names += std::string(",/users/u/") + column;
      row += ",0";
    }
    for (; !forces.empty(); forces.remove_prefix(1)) {
      names += std::string(forces[0] < 'a' ? ",/users/u/server_force_" : ",/users/u/force_") +
               static_cast<char>(std::tolower(forces[0]));
      row += ",1";
    }
    const Imported outcome = import(names + '\n' + row + '\n', preset("tactus"));
    return outcome.rule + (outcome.rule.empty() ? "" : ", " + location_of(outcome.error));
  };
  EXPECT_EQ(location("xyz"), "");
  EXPECT_EQ(location("XYZ"), "");
  EXPECT_EQ(location("xyzXYZ"), "");
  EXPECT_EQ(location(""), "R-CSV-2, line 1, column /users/u/force_x");
  EXPECT_EQ(location("xz"), "R-CSV-2, line 1, column /users/u/force_y");
  EXPECT_EQ(location("xyzXZ"), "R-CSV-2, line 1, column /users/u/server_force_y");
  EXPECT_EQ(location("yzXYZ"), "R-CSV-2, line 1, column /users/u/force_x");
}

TEST(Csv, KinaestheticLayout) {
  const Imported outcome = import(
      "human_position_x,human_position_y,human_position_z,human_velocity_x,human_velocity_y,human_velocity_z,robot_position_x,"
      "robot_position_y,robot_position_z,robot_force_x,robot_force_y,robot_force_z\n"
      "0.1,0.2,0.3,9,9,9,1,2,3,-1,-2,-3\n0.1,0.2,0.4,9,9,9,1,2,3.5,-1,-2,-4\n",
      preset("kinaesthetic"));
  ASSERT_EQ(outcome.rule, "");
  EXPECT_EQ(outcome.info.tick_rate, 1000u);
  ASSERT_EQ(outcome.frames.size(), 2u);
  const TraceFrame& frame = outcome.frames[1];
  EXPECT_EQ(frame.objects[0].pose.position, (Vec3{1, 2, 3.5}));
  EXPECT_NEAR(frame.objects[0].velocity.z, 500, 1e-9);
  EXPECT_EQ(frame.users[0].device.position, (Vec3{0.1, 0.2, 0.4}));
  EXPECT_EQ(frame.users[0].contact.kind, ContactKind::none);
  EXPECT_EQ(frame.users[0].force, (Vec3{-1, -2, -4}));
  EXPECT_EQ(frame.users[0].server_force, (Vec3{-1, -2, -4}));
}

TEST(Csv, MotionIsDerivedButNotAcrossSegments) {
  CsvMapping mapping = xyz();
  mapping.rotation = {"qw", "qx", "qy", "qz"};
  mapping.segment = "trial";
  mapping.length_scale = 0.001;
  std::ostringstream text;
  text << "trial,x,y,z,qw,qx,qy,qz\n";
  text.precision(17);
  for (int i = 0; i < 6; ++i) {
    const double angle = 0.01 * i;  // about z
    text << (i < 3 ? "a" : "b") << ',' << 20 * i << ",0,0," << std::cos(angle / 2) << ",0,0," << std::sin(angle / 2) << '\n';
  }
  const Imported outcome = import(text.str(), mapping);
  ASSERT_EQ(outcome.rule, "");
  EXPECT_EQ(outcome.done.segments, 2u);
  ASSERT_EQ(outcome.frames.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    const bool begins = i % 3 == 0;
    EXPECT_NEAR(outcome.frames[i].objects[0].velocity.x, begins ? 0.0 : 2.0, 1e-9) << i;
    EXPECT_NEAR(outcome.frames[i].objects[0].angular_velocity.z, begins ? 0.0 : 1.0, 1e-9) << i;
  }
}

TEST(Csv, RateAndTicksFollowTheTimeColumn) {
  CsvMapping mapping = xyz();
  mapping.tick_rate = 0;
  mapping.time = "t";
  mapping.segment = "s";
  const Imported outcome =
      import("t,s,x,y,z\n5.000,1,0,0,0\n5.002,1,0,0,0\n5.0039,1,0,0,0\n5.010,1,0,0,0\n0,2,0,0,0\n0.002,2,0,0,0\n", mapping);
  ASSERT_EQ(outcome.rule, "");
  EXPECT_EQ(outcome.info.tick_rate, 500u);
  std::vector<std::int64_t> ticks;
  for (const TraceFrame& frame : outcome.frames) ticks.push_back(frame.tick);
  EXPECT_EQ(ticks, (std::vector<std::int64_t>{0, 1, 2, 5, 6, 7}));
  EXPECT_EQ(outcome.done.ticks.count(), 6u);
  EXPECT_EQ(outcome.done.ticks.length(), 8u);
  mapping.resample = false;
  const Imported back = import("t,s,x,y,z\n1.0,1,0,0,0\n1.002,1,0,0,0\n1.002,1,0,0,0\n1.004,1,0,0,0\n", mapping);
  EXPECT_EQ(back.rule, "R-CSV-5");
  EXPECT_EQ(back.error.line, 4u);
}

TEST(Csv, LineEndsQuotesBlanksAndByteOrderMark) {
  const Imported outcome = import("\xEF\xBB\xBF\"x\" , y,z\r\n1, 2 ,\"3\"\r\n\r\n4,5,6\r\n", xyz());
  ASSERT_EQ(outcome.rule, "");
  ASSERT_EQ(outcome.frames.size(), 2u);
  EXPECT_EQ(outcome.frames[0].objects[0].pose.position, (Vec3{1, 2, 3}));
  EXPECT_EQ(outcome.frames[1].objects[0].pose.position, (Vec3{4, 5, 6}));
}

TEST(Csv, SemicolonsTabsDecimalCommasAndComments) {
  const auto check = [](std::string_view text) {
    const Imported outcome = import(text, xyz());
    ASSERT_EQ(outcome.rule, "") << text;
    ASSERT_EQ(outcome.frames.size(), 2u) << text;
    EXPECT_EQ(outcome.frames[0].objects[0].pose.position, (Vec3{1.5, -2e-3, 3})) << text;
    EXPECT_EQ(outcome.frames[1].objects[0].pose.position, (Vec3{4, 5, 6})) << text;
  };
  check("x;y;z\n1,5;-2,0e-3;3\n4;5;6\n");
  check("x;y;z;a, b\n1.5;-0.002;3;0\n4;5;6;0\n");
  check("x\ty\tz\n1,5\t-0,002\t3\n4\t5\t6\n");
  check("x\ty\tz\tnote\n1.5\t-0.002\t3\t\n4\t5\t6\t\n");  // an empty field at the end is one
  check("x,\ty,\tz\n1.5,\t-0.002,\t3\n4,\t5,\t6\n");
  check("x,y,z,\"m;s\"\n1.5,-0.002,3,0\n4,5,6,0\n");
  check("# made by hand\n% of 2 samples\nx,y,z\n# the first\n1.5,-2e-3,3\n4,5,6\n# the end");
  check("# nothing\n# x,y,z\n1.5,-2e-3,3\n4,5,6\n");  // as numpy.savetxt writes names
  check("# x;y;z\n1,5;-0,002;3,0\n4,0;5,0;6,0\n");    // more commas than semicolons
  check("#x;y;z\r\n1,5;-0,002;3\r\n4;5;6\r\n");
  EXPECT_EQ(import("# x,y\n1,2,3\n", xyz()).rule, "R-CSV-2");
  EXPECT_EQ(import("x;y;z\n1.000,5;2;3\n", xyz()).rule, "R-CSV-4");
  EXPECT_EQ(import("x;y;z\n1,000,5;2;3\n", xyz()).rule, "R-CSV-4");
  EXPECT_EQ(import("x;y;z\n1,2,3\n", xyz()).rule, "R-CSV-3");
  EXPECT_EQ(location_of(import("# a\n\nx;y\n1;2\n", xyz()).error), "line 3, column z");
}

TEST(Csv, MistakesAreNamedWithTheirLocation) {
  const auto check = [](std::string_view text, std::string_view rule, std::string_view location) {
    const Imported outcome = import(text, xyz());
    EXPECT_EQ(outcome.rule, rule) << text;
    EXPECT_EQ(location_of(outcome.error), location) << text;
  };
  check("", "R-CSV-1", "line 1");
  check("x,y,z\n", "R-CSV-1", "line 2");
  check("x,y\n1,2\n", "R-CSV-2", "line 1, column z");
  check("x,y,z,x\n1,2,3,4\n", "R-CSV-2", "line 1, column x");
  check("x,y,z\n1,2,3\n\n1,2\n", "R-CSV-3", "line 4");
  check("x,y,z\n1,2,3,4\n", "R-CSV-3", "line 2");
  for (const char* bad : {"1e999", "1.5x", "0x10", "1 2", "--1", "+-1"})
    check(std::string("x,y,z\n1,2,3\n4,") + bad + ",6\n", "R-CSV-4", std::string("line 3, column y, '") + bad + '\'');
  check("x,y,z\n1,\"2\"3,4\n1,\"2\"x,3\n", "R-CSV-4", "line 3, column y, '2x'");
  check("x,y,z\n" + std::string((1u << 20) + (1u << 17), '1'), "R-CSV-6", "line 2");
}

TEST(Csv, AComponentThatTheTableLacksIsZero) {
  CsvMapping plane;
  plane.device = {"x", kZeroColumn, "y"};
  plane.tick_rate = 100;
  const Imported out = import("x,y\n1,2\n3,4\n", plane);
  ASSERT_EQ(out.frames.size(), 2u);
  EXPECT_EQ(out.frames[1].users[0].device.position, (Vec3{3, 0, 4}));
  const Imported named = import("x,y,0\n1,2,5\n", plane);
  ASSERT_EQ(named.frames.size(), 1u);
  EXPECT_EQ(named.frames[0].users[0].device.position, (Vec3{1, 5, 2})) << "a column of this name";
  plane.segment = kZeroColumn;
  EXPECT_EQ(import("x,y\n1,2\n", plane).rule, "R-CSV-2") << "only components";
}

TEST(Csv, MappingsThatMakeNoSense) {
  CsvMapping partly = xyz();
  partly.position[1].clear();
  EXPECT_EQ(import("x,y,z\n1,2,3\n", partly).rule, "R-CSV-8");
  EXPECT_EQ(import("x,y,z\n1,2,3\n", CsvMapping()).rule, "R-CSV-8");
  CsvMapping no_rate = xyz();
  no_rate.tick_rate = 0;
  EXPECT_EQ(import("x,y,z\n1,2,3\n", no_rate).rule, "R-CSV-7");
  CsvMapping bad_name = xyz();
  bad_name.object = "a/b";
  EXPECT_EQ(import("x,y,z\n1,2,3\n", bad_name).rule, "R-TRC-17");
  const TempFile out;
  EXPECT_EQ(import_csv(out.path() + ".absent", xyz(), out.path()).error().error.code, Errc::io);
}

TEST(Csv, TheTicksThatAClientShowsAreKept) {
  Recording recording = make_recording(3);
  recording.info.shows_past = true;
  for (TraceFrame& frame : recording.frames) frame.shown = frame.tick / 2;
  const TempFile trace;
  write_recording(recording, trace.path());
  std::ostringstream text;
  auto reader = TraceReader::open(trace.path());
  ASSERT_TRUE(export_csv(*reader, text));
  EXPECT_TRUE(text.str().starts_with("tick,time_s,shown_tick,/objects/cube/dof"));
  const Imported outcome = import(text.str(), preset("tactus"));
  ASSERT_EQ(outcome.frames.size(), 3u) << outcome.rule;
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(image(outcome.frames[i]), image(recording.frames[i])) << i;
}

TEST(Csv, TactusLayoutDistrustsItsNumbers) {
  const Recording recording = make_recording(3);
  const TempFile trace;
  write_recording(recording, trace.path());
  auto reader = TraceReader::open(trace.path());
  std::ostringstream text;
  ASSERT_TRUE(export_csv(*reader, text));
  const auto with = [&text](std::string_view from, std::string_view to) {
    std::string changed = text.str();
    changed.replace(changed.find(from), from.size(), to);
    return import(changed, preset("tactus")).rule;
  };
  EXPECT_EQ(with("\n0,0,63,", "\n0,0,63,"), "");
  EXPECT_EQ(with("\n0,0,63,", "\n0,0,64,"), "R-CSV-4");
  EXPECT_EQ(with("\n0,0,63,", "\n0,0,7,"), "R-CSV-4");  // not what the next row says
  EXPECT_EQ(with("\n0,0,63,", "\n0.5,0,63,"), "R-CSV-4");
  EXPECT_EQ(with("\n0,0,63,", "\n7,0,63,"), "R-CSV-5");
  EXPECT_EQ(with("/users/left/contact_object", "/users/left/elsewhere"), "R-CSV-2");
  for (const char* column : {"device_qw", "device_qy", "device_vx", "device_vz", "device_buttons", "device_time_ns"}) {
    const std::string path = std::string("/users/left/") + column;
    EXPECT_EQ(with(path, "/users/left/misspelt"), "R-CSV-2") << column;
    EXPECT_EQ(with(path, "/users/left/device_x"), "R-CSV-2") << column;  // twice
  }
  EXPECT_EQ(with("\n1,0.001,63,", "\n1,0.0014,63,"), "");
  EXPECT_EQ(with("\n1,0.001,63,", "\n1,0.0016,63,"), "R-CSV-5");
  EXPECT_EQ(with("\n2,0.002,63,", "\n2,0,63,"), "R-CSV-7");
}

TEST(Csv, TactusLayoutDistrustsDevices) {
  constexpr std::string_view kNames =
      "tick,time_s,/objects/cube/dof,/objects/cube/x,/objects/cube/y,/objects/cube/z,/objects/cube/qw,/objects/cube/qx,"
      "/objects/cube/qy,/objects/cube/qz,/objects/cube/vx,/objects/cube/vy,/objects/cube/vz,/objects/cube/wx,/objects/cube/wy,"
      "/objects/cube/wz,/users/u/contact,/users/u/contact_object,/users/u/device_x,/users/u/device_y,/users/u/device_z,"
      "/users/u/force_x,/users/u/force_y,/users/u/force_z,/users/u/server_force_x,/users/u/server_force_y,/users/u/"
      "server_force_z,"
      "/users/u/point_x,/users/u/point_y,/users/u/point_z,/users/u/normal_x,/users/u/normal_y,/users/u/normal_z,"
      "/users/u/stiffness,/users/u/device_qw,/users/u/device_qx,/users/u/device_qy,/users/u/device_qz,/users/u/device_buttons,"
      "/users/u/device_time_ns\n";
  const auto check = [&](const std::string& contact, const std::string& device, std::string_view rule,
                         std::string_view location) {
    const Imported outcome = import(std::string(kNames) + "0,0,63,0,0,0,1,0,0,0,0,0,0,0,0,0," + contact +
                                        ",0,0,0,0,0,0,0,0,0,0,0,0,0,0,1,100," + device + "\n",
                                    preset("tactus"));
    EXPECT_EQ(outcome.rule, rule) << device;
    EXPECT_EQ(location_of(outcome.error), location) << device;
  };
  check("1,0", "0.6,0,0,-0.8,3,5", "", "");
  check("1,0", "1,0,0,0,-1,5", "R-CSV-4", "line 2, column /users/u/device_buttons, '-1'");
  check("1,0", "1,0,0,0,4294967296,5", "R-CSV-4", "line 2, column /users/u/device_buttons, '4294967296'");
  check("1,0", "1,0,0,0,0,-5", "R-CSV-4", "line 2, column /users/u/device_time_ns, '-5'");
  check("1,0", "1,0,0,0,0,9223372036854775807", "R-CSV-4", "line 2, column /users/u/device_time_ns, '9223372036854775807'");
  check("1,0", "nan,0,0,0,0,5", "R-CSV-4", "line 2, column /users/u/device_qw, 'nan'");
  check("1,0", "0,0,0,0,0,5", "R-API-5", "line 2");
  check("1,0", "1,0,0,0.1,0,5", "R-API-5", "line 2");
  check("1,0", "1e200,0,0,0,0,5", "R-API-5", "line 2");
  check("1,1", "1,0,0,0,0,5", "R-CSV-4", "line 2, column /users/u/contact_object, '1'");
}

TEST(Csv, ARotationOfNoLengthIsMissing) {
  std::string tosses(kTosses);
  const std::string_view second = "0.4373504,0.2366988,0.8673623,-0.01951942";
  tosses.replace(tosses.find(second), second.size(), "0,0,0,0");
  CsvMapping mapping = preset("cube-tosses");
  const Imported held = import(tosses, mapping);
  ASSERT_EQ(held.frames.size(), 3u) << held.rule;
  EXPECT_EQ(held.frames[1].objects[0].pose.rotation, held.frames[0].objects[0].pose.rotation);
  EXPECT_FALSE(held.done.notes.all().empty());
  mapping.strict = true;
  const Imported outcome = import(tosses, mapping);
  EXPECT_EQ(outcome.rule, "R-CSV-4");
  EXPECT_EQ(location_of(outcome.error), "line 3, column qw");
}

TEST(Csv, TimesLoseNothing) {
  const auto ns = [](std::string_view text, std::int64_t unit = 1'000'000'000) {
    const auto time = parse_csv_time(text, unit);
    return time ? time->nanoseconds : -1;
  };
  EXPECT_EQ(ns("1403636579763555584", 1), 1403636579763555584);
  EXPECT_EQ(ns("1700000000.123456789"), 1700000000123456789);
  EXPECT_EQ(ns("-0.5"), -500000000);
  EXPECT_EQ(ns("1.5e-3"), 1500000);
  EXPECT_EQ(ns("2.5", 1'000'000), 2500000);
  EXPECT_EQ(ns("2001-09-09T01:46:40Z"), 1'000'000'000'000'000'000);
  EXPECT_EQ(ns("2001-09-09 03:46:40.000000001+02:00"), 1'000'000'000'000'000'001);
  EXPECT_EQ(ns("01:00:00.25"), 3600250000000);
  for (const char* wrong : {"2001-13-09T01:46:40Z", "12:61:00", "1:2", "abc", "99999999999999999999", "1.2.3"})
    EXPECT_EQ(ns(wrong), -1) << wrong;
  EXPECT_EQ(date_text(1'000'000'000'000'000'000), "2001-09-09 01:46:40 UTC");
}

TEST(Csv, NamesStateUnitsAndAxes) {
  const auto scale = [](std::string_view name, CsvDimension dimension) {
    const auto stated = unit_in_name(name, dimension);
    return stated.unit ? stated.unit->scale : 0;
  };
  for (const char* name : {"t_ms", "time_ms", "t [ms]", "t (ms)", "timeMs", "ms", "t / ms"})
    EXPECT_EQ(scale(name, CsvDimension::time), 1e-3) << name;
  EXPECT_EQ(scale("timestamp [ns]", CsvDimension::time), 1e-9);
  EXPECT_EQ(scale("TimeUS", CsvDimension::time), 1e-6);
  for (const char* name : {"x [mm]", "x_mm", "x in mm"}) EXPECT_EQ(scale(name, CsvDimension::length), 1e-3) << name;
  EXPECT_EQ(scale("pos_x (cm)", CsvDimension::length), 1e-2);
  EXPECT_EQ(scale("F [mN]", CsvDimension::force), 1e-3);
  EXPECT_EQ(scale("force_kN", CsvDimension::force), 1e3);
  for (const char* name : {"x", "pos_x", "frame_items", "Rotation X", "q_w []", "p[0]"})
    EXPECT_EQ(scale(name, CsvDimension::length), 0) << name;
  EXPECT_EQ(unit_in_name("x [deg]", CsvDimension::length).foreign, "deg");
  for (const char* name : {"w", "qw", "q_w []", "Rotation W", "pose.orientation.w", "quatW"})
    EXPECT_EQ(axis_in_name(name), 'w') << name;
  EXPECT_EQ(axis_in_name("yaw_deg"), 'z');
  EXPECT_EQ(axis_in_name("a"), 0);
}

TEST(Csv, NotesCountWhatWasDecided) {
  std::string table = "t,x,y,z\n";
  for (int i = 0; i < 100; ++i) {
    const bool is_missing = i == 3 || (i >= 40 && i < 70);
    table += std::to_string(0.01 * i) + (is_missing ? ",,0,0\n" : ",1,0,0\n");
    if (i == 80) table += "0.8,2,0,0\n";  // the same time again
  }
  CsvMapping mapping = xyz();
  mapping.time = "t";
  const Imported outcome = import(table, mapping);
  ASSERT_EQ(outcome.frames.size(), 70u) << outcome.rule;
  EXPECT_EQ(outcome.frames.back().tick, 99);
  EXPECT_EQ(notes_of(outcome),
            (std::vector<std::string>{"a sample is interpolated, over at most 0.02 s",
                                      "a tick is left out: nothing was recorded for more than 0.1 s (--gap) x30",
                                      "a row with the time, or the tick, of a row before; the last of each counts"}));
}

TEST(Csv, MissingValuesArePutBetweenTheirNeighbours) {
  for (const char* word : {"", "nan", "inf", "-", "NA", "null"}) {
    const Imported outcome = import(std::string("x,y,z\n1,2,3\n4,") + word + ",6\n5,4,7\n", xyz());
    ASSERT_EQ(outcome.frames.size(), 3u) << word << outcome.rule;
    EXPECT_EQ(outcome.frames[1].objects[0].pose.position, (Vec3{3, 3, 5})) << word;
  }
}

TEST(Csv, EveryOptionOfTheMappingChangesTheTraceOrIsRefused) {
  constexpr std::string_view kTable =
      "t,x,y,z,a,b,c,d,fx,fy,fz\n0,1,2,3,1,0,0,0,1,2,3\n0.01,2,3,4,0.6,0.8,0,0,2,3,4\n0.02,3,4,6,0.6,0,0.8,0,1,2,3\n";
  CsvMapping plain;
  plain.time = "t";
  plain.position = {"x", "y", "z"};
  plain.rotation = {"a", "b", "c", "d"};
  plain.force = {"fx", "fy", "fz"};
  const auto trace_of = [&](auto change) {
    CsvMapping mapping = plain;
    change(mapping);
    const Imported outcome = import(kTable, mapping);
    std::string all = outcome.rule + std::to_string(outcome.info.tick_rate);
    for (const TraceFrame& frame : outcome.frames) {
      const auto& bytes = image(frame);
      all.append(bytes.begin(), bytes.end());
    }
    return all;
  };
  const std::string before = trace_of([](CsvMapping&) {});
  const auto differs = [&](const char* what, auto change) { EXPECT_NE(trace_of(change), before) << what; };
  differs("time_unit", [](CsvMapping& m) { m.time_unit = "ms"; });
  differs("tick_rate", [](CsvMapping& m) { m.tick_rate = 50; });
  differs("force_unit", [](CsvMapping& m) { m.force_unit = "mN"; });
  differs("length_scale", [](CsvMapping& m) { m.length_scale = 0.001; });
  differs("quaternion_order", [](CsvMapping& m) { m.quaternion_order = QuaternionOrder::xyzw; });
  differs("axes", [](CsvMapping& m) { m.axes = {1, -3, 2}; });
  differs("skip_lines", [](CsvMapping& m) { m.text.skip_lines = 2; });
  differs("names", [](CsvMapping& m) { m.text.names = CsvNames::none; });
  differs("segment", [](CsvMapping& m) { m.segment = "fx"; });
  differs("object_column", [](CsvMapping& m) { m.object_column = "fx"; });
  for (std::size_t i = 0; i < 3; ++i) {
    differs("position", [i](CsvMapping& m) { m.position[i] = "t"; });
    differs("force", [i](CsvMapping& m) { m.force[i] = "t"; });
  }
  for (std::size_t i = 0; i < 4; ++i) differs("rotation", [i](CsvMapping& m) { m.rotation[i] = "fx"; });
}

}  // namespace
}  // namespace tactus
