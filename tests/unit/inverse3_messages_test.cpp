// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/inverse3/inverse3_messages.h>

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/unit/inverse3_fixture.h"

namespace tactus::device::inverse3 {
namespace {

const char* rule_of(std::string_view message) {
  const auto state = read_state(message, "");
  return state ? "" : state.error().rule;
}

TEST(Inverse3Messages, AStateIsRead) {
  const auto state = read_state(testing::state_message(0.01), "");
  ASSERT_TRUE(state && *state);
  EXPECT_EQ((*state)->id, "0D42");
  EXPECT_EQ((*state)->position, (Vec3{0.01, 0.02, -0.03}));
  EXPECT_EQ((*state)->velocity, (Vec3{0, 0.5, 0}));
}

TEST(Inverse3Messages, TheDeviceThatIsAskedForIsFound) {
  const std::string two =
      R"({"inverse3":[{"state":{"cursor_position":{"z":3,"y":2,"x":1}},"device_id":"a"},{"device_id":"b","state":{"cursor_position":{"x":4,"y":5,"z":6}}}]})";
  EXPECT_EQ((*read_state(two, "b"))->position, (Vec3{4, 5, 6}));
  EXPECT_EQ((*read_state(two, ""))->position, (Vec3{1, 2, 3}));
  EXPECT_FALSE(*read_state(two, "c"));
  EXPECT_FALSE(*read_state(R"({"inverse3":[]})", ""));
  EXPECT_FALSE(*read_state(R"({})", ""));
  EXPECT_FALSE(*read_state(R"({"other":[{"device_id":"a","state":{"cursor_position":{"x":1,"y":2,"z":3}}}]})", ""));
}

TEST(Inverse3Messages, WhatIsNoStateIsRefused) {
  const std::string good = testing::state_message(0.01);
  for (std::size_t size = 0; size < good.size(); ++size) EXPECT_STREQ(rule_of(good.substr(0, size)), "R-DEV-5") << size;
  EXPECT_STREQ(rule_of(good + "{}"), "R-DEV-5");
  const std::pair<const char*, const char*> wrong[] = {
      {R"("x":0.010000,)", ""},                             // a vector that is not whole
      {R"("x":0.010000)", R"("x":"0.01")"},                 // text for a number
      {R"("x":0.010000)", R"("x":[0.01])"},                 //
      {R"("x":0.010000)", R"("x":null)"},                   //
      {R"("0D42")", "7"},                                   // an id that is none
      {R"("0D42")", R"("a\"b")"},                           //
      {R"("0D42")", R"("")"},                               //
      {R"({"x":0.010000,"y":0.02,"z":-0.03})", "[1,2,3]"},  // an array for a vector
  };
  for (const auto& [from, to] : wrong) {
    std::string message = good;
    message.replace(message.find(from), std::string(from).size(), to);
    EXPECT_STREQ(rule_of(message), "R-DEV-5") << message;
  }
}

TEST(Inverse3Messages, ImpossibleNumbersAreRefused) {
  for (const char* number : {"11", "-11", "1e300"}) {
    std::string message = testing::state_message(0.01);
    message.replace(message.find("0.010000"), 8, number);
    EXPECT_STREQ(rule_of(message), "R-DEV-6") << number;
  }
  for (const char* number : {"1e999", "NaN", "Infinity", "-"}) {
    std::string message = testing::state_message(0.01);
    message.replace(message.find("0.010000"), 8, number);
    EXPECT_STREQ(rule_of(message), "R-DEV-5") << number;
  }
}

TEST(Inverse3Messages, SizeAndDepthAreBounded) {
  EXPECT_STREQ(rule_of(std::string(1000, '[')), "R-DEV-5");
  EXPECT_STREQ(rule_of(std::string(33, '[') + std::string(33, ']')), "R-DEV-5");
  EXPECT_STREQ(rule_of(std::string(32, '[') + std::string(32, ']')), "");
  EXPECT_STREQ(rule_of("{\"a\":\"" + std::string(kMostMessage, 'x') + "\"}"), "R-DEV-5");
}

TEST(Inverse3Messages, ACommandIsWhatTheServiceKnows) {
  char out[kMostCommand];
  const std::size_t size = write_command(out, std::string(kMostId, 'a'), {1.5, -2.25, 1e-9});
  const auto json = nlohmann::json::parse(std::string_view(out, size));
  const auto& device = json.at("inverse3").at(0);
  EXPECT_EQ(device.at("device_id"), std::string(kMostId, 'a'));
  const auto& values = device.at("commands").at("set_cursor_force").at("values");
  EXPECT_EQ(values.at("x"), 1.5);
  EXPECT_EQ(values.at("y"), -2.25);
  EXPECT_EQ(values.at("z"), 0);
}

}  // namespace
}  // namespace tactus::device::inverse3
