// SPDX-License-Identifier: Apache-2.0
/// The Inverse3 and its messages.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include <tactus/device/inverse3/inverse3_device.h>
#include <tactus/device/inverse3/inverse3_messages.h>
#include <tactus/device/inverse3/web_socket.h>
#include <tactus/device/servo.h>
#include "tests/unit/inverse3_fixture.h"

namespace tactus::device::inverse3 {
namespace {

using testing::Service;
using testing::state_message;

// ==== inverse3 device ====
/// Against a service of our own: no device was at hand.

tl::expected<std::unique_ptr<Device>, Diagnostic> open_at(const Service& service, const std::string& which = "") {
  return Inverse3Backend().open(which, {.service = service.address()});
}

Result<Reading> read(Device& device) { return device.read(monotonic_clock().now() + kAnswerTime); }

/// Until the service was given all of a force of 2 N: where the machine stands still, it fades meanwhile.
::testing::AssertionResult push(Servo& servo, const Service& service) {
  const std::uint64_t before = service.pushes();
  for (int i = 0; i < 5000; ++i) {
    if (!servo.next() || !servo.exert({0, 0, 2})) break;
    if (service.pushes() > before) return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure() << "no force";
}

void wait_for_no_force(const Service& service) {
  const auto begin = std::chrono::steady_clock::now();
  while (service.has_force() && std::chrono::steady_clock::now() - begin < std::chrono::seconds(10)) std::this_thread::yield();
  EXPECT_FALSE(service.has_force());
}

TEST(Inverse3, ASampleAnswersItsOwnQuestion) {
  const Service service;
  const auto device = open_at(service).value();
  EXPECT_EQ(device->capabilities().name, "inverse3:0D42");
  const auto servo = Servo::start(*device, {}).value();
  for (int i = 1; i <= 500; ++i) {
    const ServoTick tick = servo->next().value();
    EXPECT_NEAR(tick.reading.sample.position.x, 1e-5 * static_cast<double>(service.commands()), 1e-12);
    ASSERT_TRUE(servo->exert({0.1, 0, 0}));
  }
  EXPECT_GE(service.commands(), 999U) << "one of read(), one of write()";
  EXPECT_LE(service.commands(), 1000U + servo->times().halted) << "and those of who watches, where the machine stood still";
}

TEST(Inverse3, TheForceArrivesAndIsZeroAtTheEnd) {
  const Service service;
  {
    const auto device = open_at(service).value();
    const auto servo = Servo::start(*device, {}).value();
    ASSERT_TRUE(push(*servo, service));
  }
  wait_for_no_force(service);
}

TEST(Inverse3, ACallerThatHangsIsHalted) {
  const Service service;
  const auto device = open_at(service).value();
  const auto servo = Servo::start(*device, {}).value();
  ASSERT_TRUE(push(*servo, service));
  wait_for_no_force(service);  // nobody calls
  EXPECT_GE(servo->times().halted, 1U);
  EXPECT_TRUE(push(*servo, service));
}

TEST(Inverse3, SilenceGarbageAndAnEndAreErrors) {
  const std::pair<std::function<std::optional<std::string>(std::uint64_t)>, const char*> answers[] = {
      {[](std::uint64_t) { return std::nullopt; }, "R-DEV-4"},
      {[](std::uint64_t) { return "{"; }, "R-DEV-5"},
      {[](std::uint64_t) { return std::string(100'000, ' '); }, "R-DEV-4"},
      {[](std::uint64_t) { return state_message(1e6); }, "R-DEV-6"},
      {[](std::uint64_t) { return state_message(0, "another"); }, "R-DEV-4"},
      {[](std::uint64_t n) {
         if (n == 20) std::this_thread::sleep_for(std::chrono::nanoseconds(2 * kAnswerTime));
         return state_message(0);
       },
       "R-DEV-4"},
  };
  for (const auto& [answer, rule] : answers) {
    const Service service(answer);
    const auto device = open_at(service).value();
    Result<Reading> reading = read(*device);
    for (int i = 0; i < 100 && reading; ++i) reading = read(*device);
    ASSERT_FALSE(reading) << rule;
    EXPECT_STREQ(reading.error().rule, rule);
    EXPECT_STREQ(read(*device).error().rule, rule) << "it stays so";
  }
}

TEST(Inverse3, AServiceThatDiesEndsTheUse) {
  auto service = std::make_unique<Service>();
  const auto device = open_at(*service).value();
  const auto servo = Servo::start(*device, {}).value();
  ASSERT_TRUE(push(*servo, *service));
  service->stop();
  Result<void> done;
  for (int i = 0; i < 100 && done; ++i) {
    const auto tick = servo->next();
    done = tick ? servo->exert({0, 0, 2}) : Result<void>(tl::unexpected(tick.error()));
  }
  ASSERT_FALSE(done);
  EXPECT_STREQ(done.error().rule, "R-DEV-4");
}

TEST(Inverse3, WhatIsNotThereIsSaid) {
  std::string address;
  {
    const Service service;
    address = service.address();
    const auto other = open_at(service, "another");
    ASSERT_FALSE(other);
    EXPECT_STREQ(other.error().error.rule, "R-DEV-1");
  }
  const auto nobody = Inverse3Backend().open("", {.service = address});
  EXPECT_STREQ(nobody.error().error.rule, "R-DEV-3");
  EXPECT_STREQ(Inverse3Backend().open("", {.service = "192.0.2.1:80"}).error().error.rule, "R-DEV-3");
  const Service empty([](std::uint64_t) { return std::nullopt; }, R"({"inverse3":[]})");
  EXPECT_STREQ(open_at(empty).error().error.rule, "R-DEV-1");
}

// ==== inverse3 messages ====

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

// ==== web socket ====

Time in(Time span) { return monotonic_clock().now() + span; }

TEST(WebSocket, OnlyThisMachineIsSpokenTo) {
  for (const char* address : {"192.0.2.1:80", "example.org:80", "127.0.0.1", "127.0.0.1:", "127.0.0.1:0", "127.0.0.1:65536",
                              "127.0.0.1:80x", ":80", "", "[::2]:80"}) {
    const auto socket = WebSocket::connect(address, 1000, in(kAnswerTime));
    ASSERT_FALSE(socket) << address;
    EXPECT_NE(socket.error().find("is not HOST:PORT on this machine"), std::string::npos) << address;
  }
}

TEST(WebSocket, NobodyThereIsSaid) {
  std::string address;
  {
    const testing::Service service;
    address = service.address();
  }
  const auto socket = WebSocket::connect(address, 1000, in(10 * kAnswerTime));
  ASSERT_FALSE(socket);
  EXPECT_NE(socket.error().find(address), std::string::npos);
}

TEST(WebSocket, MessagesGoBothWays) {
  testing::Service service([](std::uint64_t n) { return "answer " + std::to_string(n); }, "hello");
  const auto socket = WebSocket::connect(service.address(), 1000, in(10 * kAnswerTime)).value();
  ASSERT_EQ(socket->receive(in(10 * kAnswerTime)), WebSocket::Status::done);
  EXPECT_EQ(socket->message(), "hello");
  EXPECT_EQ(socket->receive(in(5 * kMillisecond)), WebSocket::Status::timeout);
  for (int i = 1; i < 100; ++i) {
    ASSERT_EQ(socket->send("question", in(10 * kAnswerTime)), WebSocket::Status::done);
    ASSERT_EQ(socket->receive(in(10 * kAnswerTime)), WebSocket::Status::done);
    EXPECT_EQ(socket->message(), "answer " + std::to_string(i));
  }
  EXPECT_EQ(service.last_command(), "question");
}

TEST(WebSocket, ALongMessageEndsTheConnection) {
  const testing::Service service([](std::uint64_t) { return std::nullopt; }, std::string(1001, 'x'));
  const auto socket = WebSocket::connect(service.address(), 1000, in(10 * kAnswerTime)).value();
  EXPECT_EQ(socket->receive(in(10 * kAnswerTime)), WebSocket::Status::gone);
  EXPECT_EQ(socket->receive(in(10 * kAnswerTime)), WebSocket::Status::gone);
  EXPECT_EQ(socket->send("x", in(10 * kAnswerTime)), WebSocket::Status::gone);
}

}  // namespace
}  // namespace tactus::device::inverse3
