// SPDX-License-Identifier: Apache-2.0
#include <tactus/seal/association.h>

#include "tests/unit/seal_fixture.h"

namespace tactus::seal {
namespace {

using tactus::testing::Bytes;
using tactus::testing::key_of;

Bytes record(std::uint8_t content, std::uint8_t version, std::uint8_t size) {
  Bytes out{content, 0xFE, version, 0, 1, 0, 0, 0, 0, 1, 2, 0, size};
  out.resize(13u + 4, 7);
  return out;
}

TEST(SealAssociation, HeadsOfRecordsAreRead) {
  const auto head = read_head(record(23, 0xFD, 4));
  ASSERT_TRUE(head);
  EXPECT_EQ(head->content, Content::application_data);
  EXPECT_EQ(head->epoch, 1u);
  EXPECT_EQ(head->number, 0x102u);
  EXPECT_TRUE(head->is_alone);
  Bytes two = record(22, 0xFD, 4), more = record(20, 0xFD, 4);
  two.insert(two.end(), more.begin(), more.end());
  ASSERT_TRUE(read_head(two));
  EXPECT_FALSE(read_head(two)->is_alone);
  EXPECT_FALSE(read_head(std::span(two).first(33))) << "the second is cut";
  EXPECT_FALSE(read_head(std::span(two).first(20))) << "its head is cut";
  EXPECT_FALSE(read_head(record(23, 0xFD, 3))) << "what follows is no record";
  EXPECT_TRUE(read_head(record(22, 0xFF, 4))) << "a ClientHello may say DTLS 1.0 in its record";
  EXPECT_FALSE(read_head(record(23, 0xFD, 5))) << "cut";
  EXPECT_FALSE(read_head(record(23, 0xFE, 4)));
  EXPECT_FALSE(read_head(record(19, 0xFD, 4)));
  EXPECT_FALSE(read_head(record(24, 0xFD, 4)));
  EXPECT_FALSE(read_head(Bytes(12, 22)));
  EXPECT_FALSE(read_head({}));
  EXPECT_FALSE(message_type(record(22, 0xFD, 4))) << "too short for a message";
}

/// Without client and server around it: who owns an association decides what travels.
TEST(SealAssociation, AFlightIsOneDatagramAndCanBeSentAgain) {
  const auto context = Context::create(key_of(), {}).value();
  const auto client = Association::client(*context).value();
  client->advance({});
  ASSERT_TRUE(client->has_spoken());
  EXPECT_EQ(message_type(client->flight()), kClientHello);
  Cookies cookies = Cookies::create(0).value();
  const Bytes who{1, 2, 3};
  client->advance(cookies.answer(who));
  const auto server = Association::server(*context, cookies.look(0, who, client->flight()).state).value();
  EXPECT_EQ(server->advance(client->flight()), Association::Stage::handshake);
  ASSERT_TRUE(server->has_spoken());
  const Bytes hello(server->flight().begin(), server->flight().end());
  EXPECT_LT(hello.size(), kLargestSealed / 4);
  server->advance(client->flight());
  EXPECT_FALSE(server->has_spoken()) << "a copy says nothing new";
  EXPECT_EQ(hello, Bytes(server->flight().begin(), server->flight().end()));
  client->advance(hello);
  EXPECT_EQ(message_type(client->flight()), kClientKeyExchange);
  EXPECT_EQ(server->advance(client->flight()), Association::Stage::open);
  EXPECT_EQ(client->advance(server->flight()), Association::Stage::open);
}

TEST(SealAssociation, OneSuiteAndNoOther) {
  const auto context = Context::create(key_of(), {}).value();
  const auto client = Association::client(*context).value();
  client->advance({});
  const auto hello = client->flight();
  const std::size_t suites = 13 + 12 + 2 + 32 + 2;  // heads, version, random, no session, no cookie
  ASSERT_GT(hello.size(), suites + 6);
  const std::size_t count = (std::size_t{hello[suites]} << 8 | hello[suites + 1]) / 2;
  std::vector<unsigned> offered;
  for (std::size_t i = 0; i < count; ++i) offered.push_back(256u * hello[suites + 2 + 2 * i] + hello[suites + 3 + 2 * i]);
  std::erase(offered, 0x00FFu);  // no suite: "renegotiation is safe" (RFC 5746)
  EXPECT_EQ(offered, std::vector{0xCCACu}) << "TLS_ECDHE_PSK_WITH_CHACHA20_POLY1305_SHA256";
}

}  // namespace
}  // namespace tactus::seal
