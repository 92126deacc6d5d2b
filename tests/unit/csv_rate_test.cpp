// SPDX-License-Identifier: Apache-2.0
/// When the rows of a table were, and what their rotations and devices are: motions that are known, written as recorders write them.
#include <tactus/trace/csv_rate.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <sstream>

#include "tests/unit/csv_fixture.h"

namespace tactus {
namespace {

/// Row i of a body that moves along x with 1 m/s is at i / `rate` m.
std::string moving(int rows, double rate, const std::function<double(int)>& time_of) {
  std::ostringstream text;
  text << "t,x,y,z\n";
  text.precision(12);
  for (int i = 0; i < rows; ++i) text << time_of(i) << ',' << i / rate << ",0,0\n";
  return text.str();
}

CsvMapping timed() {
  CsvMapping mapping = xyz();
  mapping.tick_rate = 0;
  mapping.time = "t";
  return mapping;
}

/// Ticks are whole, positions on the line, and velocities 1 m/s within `error`.
void expect_even(const Imported& outcome, std::uint32_t rate, double error) {
  ASSERT_EQ(outcome.rule, "") << to_string(outcome.error);
  EXPECT_EQ(outcome.info.tick_rate, rate);
  for (std::size_t i = 1; i < outcome.frames.size(); ++i) {
    ASSERT_EQ(outcome.frames[i].tick, outcome.frames[i - 1].tick + 1);
    ASSERT_NEAR(outcome.frames[i].objects[0].velocity.x, 1, error) << i;
  }
}

TEST(CsvRate, RowsThatComeInBurstsAreSpreadEvenly) {
  const auto burst = [](int i) { return i / 10 * 0.01; };
  const Imported equal = import(moving(300, 1000, burst), timed());
  expect_even(equal, 1000, 1e-9);
  EXPECT_EQ(equal.frames.size(), 300u);
  EXPECT_EQ(equal.frames[7].objects[0].pose.position.x, 0.007);
  EXPECT_EQ(notes_of(equal), (std::vector<std::string>{
                                 "several rows share a time or come in groups, of 10 rows each 0.01 s: spread evenly, 1000 rows "
                                 "per second"}));
  expect_even(import(moving(300, 1000, [&](int i) { return burst(i) + i % 10 * 2e-5; }), timed()), 1000, 1e-9);  // nearly at once
  const auto in_seconds = [](int i) { return std::floor((i + 370) / 1000.0); };  // a clock of whole seconds, begun within one
  const Imported coarse = import(moving(6000, 1000, in_seconds), timed());
  expect_even(coarse, 1000, 1e-9);
  EXPECT_EQ(coarse.frames.size(), 6000u);
  expect_even(import(moving(600, 120, [](int i) { return std::floor(i / 1.2 + 1e-9) / 100; }), timed()), 120, 1e-3);
  expect_even(import(moving(600, 110, [](int i) { return std::floor(i / 1.1 + 1e-9) / 100; }), timed()), 110, 1e-3);
  expect_even(import(moving(960, 960, [](int i) { return i / 8 / 120.0; }), timed()), 960, 1e-5);
}

/// Where the limits are: what is 0.4 s apart came in groups, what is 0.6 s apart are pauses; so with rates above 50 kHz.
TEST(CsvRate, LimitsOfGroupsAndRates) {
  for (const double seconds : {0.4, 0.6}) {
    const auto time = [=](int i) { return i / 10 * seconds + i % 10 * 1e-4; };
    CsvMapping mapping = timed();
    mapping.time_unit = "s";
    const Imported outcome = import(moving(400, 10 / seconds, time), mapping);
    ASSERT_EQ(outcome.rule, "") << seconds;
    const std::vector<std::string> notes = notes_of(outcome);
    const bool reported =
        std::ranges::any_of(notes, [](const std::string& note) { return note.find("come in groups") != note.npos; });
    EXPECT_EQ(reported, seconds < 0.5) << seconds;
  }
  for (const double rate : {48'000.0, 52'000.0}) {
    const Imported outcome = import(moving(400, rate, [=](int i) { return i / rate; }), timed());
    EXPECT_EQ(outcome.rule, rate > 50'000 ? "R-CSV-11" : "") << rate;
  }
}

TEST(CsvRate, AClockThatDiffersFromTheRateIsFollowed) {
  const auto time = [](int i) { return i / 10 * 0.01001; };  // 999 Hz, taken as 999
  const Imported outcome = import(moving(60000, 1000 / 1.001, time), timed());
  ASSERT_EQ(outcome.rule, "");
  EXPECT_EQ(outcome.info.tick_rate, 999u);
  EXPECT_NEAR(static_cast<double>(outcome.frames.back().tick) / 999, 60.06, 0.025);
  const auto twice = [&](int i) { return time(i) + (i < 1000 ? 0 : 5); };  // a pause stays one
  CsvMapping mapping = timed();
  mapping.time_unit = "s";  // as most ticks have no row
  const Imported paused = import(moving(2000, 1000 / 1.001, twice), mapping);
  ASSERT_EQ(paused.rule, "");
  EXPECT_NEAR(static_cast<double>(paused.frames.back().tick) / 999, 7, 0.025);
  EXPECT_NEAR(static_cast<double>(paused.frames.size()), 2000, 25);
}

TEST(CsvRate, CopiesAndTruePausesAreNoBursts) {
  const auto copies = [](int i) { return i / 2 * 0.01; };
  std::string text = "t,x,y,z\n";
  for (int i = 0; i < 200; ++i) text += std::to_string(copies(i)) + ',' + std::to_string(i / 2) + ",0,0\n";
  const Imported copied = import(text, timed());
  EXPECT_EQ(copied.info.tick_rate, 100u) << copied.rule;
  EXPECT_EQ(copied.frames.size(), 100u);
  const auto pausing = [](int i) { return i / 10 * 0.1 + i % 10 * 1e-3; };  // 10 rows at 1 kHz, then 91 ms without one
  std::ostringstream rows;
  rows << "t,x,y,z\n";
  for (int i = 0; i < 300; ++i) rows << pausing(i) << ',' << pausing(i) << ",0,0\n";
  CsvMapping mapping = timed();
  mapping.tick_rate = 1000;
  const Imported paused = import(rows.str(), mapping);
  ASSERT_EQ(paused.frames.size(), 300u) << paused.rule;
  EXPECT_EQ(paused.frames[10].tick, 100);
}

/// Of a mouse or a touch screen, which report when something happened.
TEST(CsvRate, EventsAreNoBursts) {
  std::ostringstream text;
  text << "t,x,y,z\n";
  std::uint32_t random = 1;
  double time = 0;
  for (int i = 0; i < 3000; ++i) {
    text << time << ',' << time << ",0,0\n";
    random = random * 1664525 + 1013904223;
    time += -0.01 * std::log((static_cast<double>(random >> 8) + 1) / (1 << 24));
  }
  const Imported outcome = import(text.str(), timed());
  ASSERT_EQ(outcome.rule, "") << to_string(outcome.error);
  EXPECT_NEAR(outcome.info.tick_rate, 100, 10);
  for (std::size_t i = 1; i < outcome.frames.size(); ++i)
    ASSERT_NEAR(outcome.frames[i].objects[0].pose.position.x,
                static_cast<double>(outcome.frames[i].tick) / outcome.info.tick_rate, 1e-3);
}

TEST(CsvRate, StrictAndNoResampleRefuseBursts) {
  const std::string text = moving(300, 1000, [](int i) { return i / 10 * 0.01; });
  CsvMapping mapping = timed();
  mapping.strict = true;
  EXPECT_EQ(import(text, mapping).rule, "R-CSV-5");
  mapping.strict = false;
  mapping.resample = false;
  EXPECT_EQ(import(text, mapping).rule, "R-CSV-5");
}

TEST(CsvRate, RatesThatNobodyWouldRecordAreAskedAbout) {
  const auto excel = [](int i) { return 45413.5 + i * 0.01 / 86400; };
  std::ostringstream text;
  text << "t,x,y,z\n";
  text.precision(17);
  for (int i = 0; i < 100; ++i) text << excel(i) << ',' << i << ",0,0\n";
  CsvMapping mapping = timed();
  const Imported asked = import(text.str(), mapping);
  EXPECT_TRUE(asked.rule == "R-CSV-11" || asked.rule == "R-CSV-7") << asked.rule;
  EXPECT_NE(asked.error.remedy.find("day"), std::string::npos) << asked.error.remedy;
  mapping.time_unit = "day";
  const Imported dated = import(text.str(), mapping);
  EXPECT_EQ(dated.info.tick_rate, 100u) << dated.rule;
  EXPECT_EQ(dated.frames.size(), 100u);
  EXPECT_EQ(notes_of(dated).front(), "time begins at 0 in the trace; the first row is of 2024-05-01 12:00:00 UTC");
}

// ==== times in two columns ====

TEST(CsvRate, DatesAndClocksAndSecondsAndNanosecondsAreOneTime) {
  const auto check = [](std::string_view names, const std::function<std::string(int)>& time_of, const char* time) {
    std::string text = std::string(names) + ",x,y,z\n";
    for (int i = 0; i < 40; ++i) text += time_of(i) + ',' + std::to_string(i) + ",0,0\n";
    CsvMapping mapping = timed();
    mapping.time = time;
    const Imported outcome = import(text, mapping);
    ASSERT_EQ(outcome.rule, "") << names << to_string(outcome.error);
    EXPECT_EQ(outcome.info.tick_rate, 100u) << names;
    ASSERT_EQ(outcome.frames.size(), 40u) << names;
    EXPECT_EQ(outcome.frames[30].tick, 30) << names;
    EXPECT_EQ(outcome.frames[30].objects[0].pose.position.x, 30) << names;
  };
  const auto stamp = [](int i) {  // across a full second
    const int centiseconds = 99 + i - 10;
    return std::to_string(1700000000 + centiseconds / 100) + ',' + std::to_string(centiseconds % 100 * 10'000'000);
  };
  check("header.stamp.sec,header.stamp.nanosec", stamp, "header.stamp.sec");
  check("secs,nsecs", stamp, "secs");
  check("a,b_ns", stamp, "a,b_ns");
  const auto night = [](int i, const char* before, const char* after) {  // across midnight
    char clock[40];
    std::snprintf(clock, sizeof clock, i < 20 ? "23:59:59.%03d" : "00:00:00.%03d", i < 20 ? 800 + 10 * i : 10 * (i - 20));
    return std::string(i < 20 ? before : after) + ',' + clock;
  };
  check(
      "date,time", [&](int i) { return night(i, "2024-02-28", "2024-02-29"); }, "date,time");
  check(
      "Datum,Uhrzeit", [&](int i) { return night(i, "31.12.2023", "1.1.2024"); }, "Datum,Uhrzeit");
  check(
      "Date,Time", [&](int i) { return night(i, "4/30/2024", "5/1/2024"); }, "Time");  // the clock alone passes midnight
  check(
      "d,t", [&](int i) { return night(i, "31-Dec-2023", "01-Jan-2024"); }, "d,t");
}

TEST(CsvRate, ADateThatCanBeTwoIsAskedAbout) {
  const std::string_view text =
      "d,t,x,y,z\n5/6/2024,1:00:00.00 PM,1,0,0\n5/6/2024,1:00:00.01 PM,2,0,0\n5/6/2024,1:00:00.02 PM,3,0,0\n";
  CsvMapping mapping = timed();
  mapping.time = "d,t";
  const Imported asked = import(text, mapping);
  EXPECT_EQ(asked.rule, "R-CSV-4");
  EXPECT_EQ(asked.error.remedy, "Say which number is the month: --date-order mdy or dmy.");
  for (const auto& [order, date] : {std::pair{CsvDateOrder::mdy, "2024-05-06"}, {CsvDateOrder::dmy, "2024-06-05"}}) {
    mapping.date_order = order;
    const Imported outcome = import(text, mapping);
    EXPECT_EQ(outcome.frames.size(), 3u) << outcome.rule;
    EXPECT_EQ(notes_of(outcome).front(),
              std::string("time begins at 0 in the trace; the first row is of ") + date + " 13:00:00 UTC");
  }
}

TEST(CsvRate, AFractionThatIsAWholeTimeIsRefused) {
  CsvMapping mapping = timed();
  mapping.time = "sec";
  const Imported outcome = import("sec,nanosec,x,y,z\n0,0,1,0,0\n0,500000000,2,0,0\n1,1000000000,3,0,0\n", mapping);
  EXPECT_EQ(outcome.rule, "R-CSV-4");
  EXPECT_EQ(outcome.error.line, 4u);
  mapping.time = "nanosec";  // the remedy
  mapping.tick_rate = 2;
  EXPECT_EQ(import("sec,nanosec,x,y,z\n0,0,1,0,0\n0,500000000,2,0,0\n1,1000000000,3,0,0\n", mapping).frames.size(), 3u);
}

// ==== recordings put together ====

TEST(CsvRate, WhereTheTimeFallsTheNextRecordingBeginsIfItIsSaid) {
  std::string one = "t,x,y,z\n", text;
  for (int i = 0; i < 200; ++i) one += std::to_string(i / 100.0) + ',' + std::to_string(i) + ",0,0\n";
  text = one + "\xEF\xBB\xBF" + one + one;
  CsvMapping mapping = timed();
  const Imported refused = import(text, mapping);
  EXPECT_EQ(refused.rule, "R-CSV-5");
  EXPECT_NE(refused.error.remedy.find("--restarts"), std::string::npos);
  mapping.restarts = true;
  const Imported outcome = import(text, mapping);
  ASSERT_EQ(outcome.frames.size(), 600u) << outcome.rule;
  EXPECT_EQ(outcome.done.segments, 3u);
  EXPECT_EQ(outcome.frames[400].objects[0].pose.position.x, 0);
  EXPECT_EQ(outcome.frames[400].objects[0].velocity.x, 0);
  EXPECT_EQ(notes_of(outcome), (std::vector<std::string>{"the time falls: another segment begins x2",
                                                         "a line of names comes again and is left out x2"}));
}

TEST(CsvRate, RowsInReverseAreNamedAsThat) {
  std::string text = "t,x,y,z\n";
  for (int i = 199; i >= 0; --i) text += std::to_string(i / 100.0) + ',' + std::to_string(i) + ",0,0\n";
  const Imported outcome = import(text, timed());
  EXPECT_EQ(outcome.rule, "R-CSV-5");
  EXPECT_EQ(outcome.error.remedy, "Turn the rows around, as by tac.");
}

// ==== rotations ====

/// About z by a quarter turn per second, from `begin` [rad].
Quat turned(double time, double begin = 0) {
  const double half = begin / 2 + time * std::numbers::pi / 4;
  return {std::cos(half), 0, 0, std::sin(half)};
}

TEST(CsvRate, TheOrderOfUnnamedQuaternionsFollowsFromTheFirst) {
  const auto table = [](const char* names, bool is_w_first, double begin) {
    std::ostringstream text;
    text.precision(17);
    text << "t,x,y,z," << names << '\n';
    for (int i = 0; i < 50; ++i) {
      const Quat q = turned(i / 100.0, begin);
      text << i / 100.0 << ",0,0,0,";
      if (is_w_first) text << q.w << ",0,0," << q.z << '\n';
      else text << "0,0," << q.z << ',' << q.w << '\n';
    }
    return text.str();
  };
  const auto check = [&](const char* names, std::array<std::string, 4> columns, bool is_w_first, double begin,
                         QuaternionOrder order) {
    CsvMapping mapping = timed();
    mapping.rotation = columns;
    mapping.quaternion_order = order;
    const Imported outcome = import(table(names, is_w_first, begin), mapping);
    if (!outcome.rule.empty()) return outcome.rule + ": " + outcome.error.remedy;
    const double size = std::abs(outcome.frames[40].objects[0].angular_velocity.z);
    const Quat q = outcome.frames[40].objects[0].pose.rotation, wanted = turned(0.4, begin);
    return std::string(std::abs(size - std::numbers::pi / 2) < 1e-6 && std::abs(q.w - wanted.w) < 1e-12 ? "right" : "wrong");
  };
  const std::string asked = "R-CSV-10: Which of the four is w? Give --quaternion-order wxyz or xyzw.";
  using enum QuaternionOrder;
  EXPECT_EQ(check("q1,q2,q3,q4", {"q1", "q2", "q3", "q4"}, true, 0, by_names), "right");
  EXPECT_EQ(check("q1,q2,q3,q4", {"q1", "q2", "q3", "q4"}, false, 0, by_names), "right");
  EXPECT_EQ(check("q1,q2,q3,q4", {"#5", "#6", "#7", "#8"}, false, 0.3, by_names), "right");
  EXPECT_EQ(check("q1,q2,q3,q4", {"q1", "q2", "q3", "q4"}, true, 2, by_names), asked);
  EXPECT_EQ(check("q1,q2,q3,q4", {"q1", "q2", "q3", "q4"}, true, 2, wxyz), "right");
  EXPECT_EQ(check("q1,q2,q3,q4", {"q1", "q2", "q3", "q4"}, false, 2, xyzw), "right");
  EXPECT_EQ(check("q0,q1,q2,q3", {"q0", "q1", "q2", "q3"}, true, 2, by_names), "right");  // from 0: mostly w first
  EXPECT_EQ(check("q0,q1,q2,q3", {"q0", "q1", "q2", "q3"}, false, 0, by_names), asked);   // but this one is not
  EXPECT_EQ(check("qx,qy,qz,scalar", {"qx", "qy", "qz", "scalar"}, false, 2, by_names), "right");
}

TEST(CsvRate, RotationVectorsAndMatrices) {
  std::ostringstream text;
  text.precision(17);
  text << "t,x,y,z,rx [deg],ry [deg],rz [deg],m00,m01,m02,m10,m11,m12,m20,m21,m22\n";
  for (int i = 0; i < 150; ++i) {
    const double a = i / 100.0 * std::numbers::pi / 2;
    text << i / 100.0 << ",0,0,0,0,0," << 90 * i / 100.0 << ',' << std::cos(a) << ',' << -std::sin(a) << ",0," << std::sin(a)
         << ',' << std::cos(a) << ",0,0,0,1\n";
  }
  CsvMapping vector = timed(), matrix = timed();
  vector.rotation_vector = {"rx", "ry", "rz"};
  matrix.rotation_matrix = {"m00", "m01", "m02", "m10", "m11", "m12", "m20", "m21", "m22"};
  for (const CsvMapping& mapping : {vector, matrix}) {
    const Imported outcome = import(text.str(), mapping);
    ASSERT_EQ(outcome.frames.size(), 150u) << outcome.rule;
    for (std::size_t i = 1; i < 150; ++i) {
      const RigidSample& sample = outcome.frames[i].objects[0];
      const Quat wanted = turned(static_cast<double>(i) / 100);
      EXPECT_NEAR(std::abs(sample.pose.rotation.w * wanted.w + sample.pose.rotation.z * wanted.z), 1, 1e-12) << i;
      EXPECT_NEAR(sample.angular_velocity.z, std::numbers::pi / 2, 1e-6) << i;
    }
  }
  std::string stretched = text.str();
  stretched.replace(stretched.find(",0,0,1\n"), 7, ",0,0,2\n");
  EXPECT_EQ(notes_of(import(stretched, matrix)).back(), "a sample is interpolated, over at most 0 s");
}

TEST(CsvRate, TheRotationOfADeviceIsKept) {
  std::string text = "t,px,py,pz,hw,hx,hy,hz\n";
  for (int i = 0; i < 20; ++i) text += std::to_string(i / 100.0) + ",1,2,3,0.6,0,0,0.8\n";
  CsvMapping mapping = timed();
  mapping.position = {};
  mapping.device = {"px", "py", "pz"};
  const Imported without = import(text, mapping);
  EXPECT_FALSE(without.info.users[0].senses.orientation);
  EXPECT_EQ(notes_of(without), std::vector<std::string>{"columns that are not read: hw, hx, hy, hz"});
  mapping.device_rotation = {"hw", "hx", "hy", "hz"};
  const Imported outcome = import(text, mapping);
  ASSERT_EQ(outcome.frames.size(), 20u) << outcome.rule;
  EXPECT_TRUE(outcome.info.users[0].senses.orientation);
  EXPECT_EQ(outcome.frames[5].users[0].device.orientation, (Quat{0.6, 0, 0, 0.8}));
  mapping.axes = {1, -3, 2};  // y up: z of the table is -y of the trace
  const Imported upright = import(text, mapping);
  EXPECT_EQ(upright.frames[5].users[0].device.position, (Vec3{1, -3, 2}));
  EXPECT_EQ(upright.frames[5].users[0].device.orientation, (Quat{0.6, 0, -0.8, 0}));
  mapping.device = {};
  EXPECT_EQ(import(text, mapping).rule, "R-CSV-8");
}

// ==== what is counted and kept ====

TEST(CsvRate, HeldSamplesAreCounted) {
  std::string text = "t,ax,ay,az,bx,by,bz\n";
  for (int i = 0; i < 100; ++i) {
    const bool is_lost = i >= 40 && i < 70;
    text += std::to_string(i / 100.0) + ',' + std::to_string(i) + (is_lost ? ",0,0,,,\n" : ",0,0,5,0,0\n");
  }
  CsvMapping mapping = timed();
  mapping.position = {};
  for (const char name : {'a', 'b'}) {
    CsvSubject& one = mapping.others.emplace_back();
    one.name = name;
    one.position = {std::string(1, name) + 'x', std::string(1, name) + 'y', std::string(1, name) + 'z'};
  }
  const Imported outcome = import(text, mapping);
  ASSERT_EQ(outcome.frames.size(), 100u) << outcome.rule;
  EXPECT_EQ(outcome.frames[55].objects[1].pose.position.x, 5);
  EXPECT_EQ(outcome.frames[55].objects[0].pose.position.x, 55);
  EXPECT_EQ(notes_of(outcome),
            std::vector<std::string>{"a sample is held, as others of the table go on: none for more than 0.1 s (--gap) x30"});
}

TEST(CsvRate, ALastLineWithoutAnEndIsTakenIfItIsSaid) {
  const std::string_view text = "x,y,z\n1,0,0\n2,0,0\n3,0,4";
  EXPECT_EQ(import(text, xyz()).frames.size(), 2u);
  CsvMapping mapping = xyz();
  mapping.keep_last = true;
  const Imported outcome = import(text, mapping);
  ASSERT_EQ(outcome.frames.size(), 3u);
  EXPECT_EQ(outcome.frames[2].objects[0].pose.position, (Vec3{3, 0, 4}));
  EXPECT_TRUE(notes_of(outcome).empty());
}

TEST(CsvRate, ADeclaredContactIsInTheTrace) {
  std::string text = "t,x,y,z,fx,fy,fz\n";
  for (int i = 0; i < 20; ++i) text += std::to_string(i / 100.0) + ",1,2,3,0,0," + (i < 10 ? "2\n" : "0\n");
  CsvMapping mapping = timed();
  mapping.force = {"fx", "fy", "fz"};
  mapping.contacts = {{.user = "user", .object = "object", .stiffness = 500, .at = ForcePoint::origin}};
  const Imported outcome = import(text, mapping);
  ASSERT_EQ(outcome.frames.size(), 20u) << outcome.rule;
  const Contact& contact = outcome.frames[5].users[0].contact;
  EXPECT_EQ(contact.kind, ContactKind::surface);
  EXPECT_EQ(contact.stiffness, 500);
  EXPECT_EQ(contact.device, (Vec3{1, 2, 3}));
  EXPECT_LT(norm(contact.point - Vec3{0, 0, 0.004}), 1e-15);  // of the object: 2 N / 500 N/m
  EXPECT_EQ(outcome.frames[15].users[0].contact.kind, ContactKind::none);
  mapping.contacts[0].object = "cup";
  const Imported refused = import(text, mapping);
  EXPECT_EQ(refused.rule, "R-API-5");
  EXPECT_EQ(refused.error.remedy, "Declare one contact for a user. Users of this table: user; objects: object.");
}

}  // namespace
}  // namespace tactus
