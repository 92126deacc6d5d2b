// SPDX-License-Identifier: Apache-2.0
/// Against a service of our own: no device was at hand.
#include <tactus/device/inverse3/inverse3_device.h>

#include <gtest/gtest.h>

#include <thread>

#include <tactus/device/servo.h>
#include "tests/unit/inverse3_fixture.h"

namespace tactus::device::inverse3 {
namespace {

using testing::Service;
using testing::state_message;

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

}  // namespace
}  // namespace tactus::device::inverse3
