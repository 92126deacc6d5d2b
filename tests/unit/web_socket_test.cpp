// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/inverse3/web_socket.h>

#include <gtest/gtest.h>

#include "tests/unit/inverse3_fixture.h"

namespace tactus::device::inverse3 {
namespace {

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
