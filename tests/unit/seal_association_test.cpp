// SPDX-License-Identifier: Apache-2.0
/// Sealed datagrams: associations, cookies, keys.
#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <tactus/seal/association.h>
#include <tactus/seal/key.h>
#include "tests/unit/seal_fixture.h"

namespace tactus::seal {
namespace {

using tactus::testing::Bytes;
using tactus::testing::bytes_of;
using tactus::testing::key_of;

// ==== seal association ====

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

// ==== seal cookies ====

using Verdict = Cookies::Verdict;

constexpr std::uint64_t kSecond = 1'000'000;

/// The ClientHello of a client, without a cookie and with that of an answer.
struct Hellos {
  Hellos() : context(Context::create(key_of(), {}).value()), client(Association::client(*context).value()) {
    client->advance({});
  }
  Bytes bare() const { return bytes_of(client->flight()); }
  Bytes with(std::span<const std::uint8_t> answer) {
    client->advance(answer);
    return bytes_of(client->flight());
  }
  std::unique_ptr<Context> context;
  std::unique_ptr<Association> client;
};

TEST(SealCookies, ProveTheAddressThatTheyWereMadeFor) {
  Cookies cookies = Cookies::create(0).value();
  const Bytes here = bytes_of("192.0.2.1:1"), there = bytes_of("192.0.2.1:2");
  Hellos hellos;
  EXPECT_EQ(cookies.look(0, here, hellos.bare()).verdict, Verdict::unvalidated);
  EXPECT_LT(cookies.answer(here).size(), hellos.bare().size()) << "shorter than what asks for it";
  const Bytes hello = hellos.with(cookies.answer(here));
  EXPECT_EQ(cookies.look(0, here, hello).verdict, Verdict::validated);
  EXPECT_EQ(cookies.look(0, there, hello).verdict, Verdict::unvalidated);
  Cookies of_another = Cookies::create(0).value();
  EXPECT_EQ(of_another.look(0, here, hello).verdict, Verdict::unvalidated);
}

TEST(SealCookies, LastFor30To60Seconds) {
  for (const std::uint64_t made : {0 * kSecond, 10 * kSecond, 29 * kSecond, 45 * kSecond}) {
    Cookies cookies = Cookies::create(0).value();
    Hellos hellos;
    const Bytes here = bytes_of("here");
    static_cast<void>(cookies.look(made, here, hellos.bare()));
    const Bytes hello = hellos.with(cookies.answer(here));
    EXPECT_EQ(cookies.look(made + 30 * kSecond, here, hello).verdict, Verdict::validated) << made;
    EXPECT_EQ(cookies.look(made + 60 * kSecond, here, hello).verdict, Verdict::unvalidated) << made;
  }
}

TEST(SealCookies, NobodyForLongEndsThemAll) {
  Cookies cookies = Cookies::create(0).value();
  Hellos hellos;
  const Bytes here = bytes_of("here");
  const Bytes hello = hellos.with(cookies.answer(here));
  EXPECT_EQ(cookies.look(3600 * kSecond, here, hello).verdict, Verdict::unvalidated);
  Hellos later;
  EXPECT_EQ(cookies.look(3600 * kSecond, here, later.with(cookies.answer(here))).verdict, Verdict::validated);
}

TEST(SealCookies, EveryPrefixAndEveryBit) {
  Cookies cookies = Cookies::create(0).value();
  Hellos hellos;
  const Bytes here = bytes_of("here"), hello = hellos.with(cookies.answer(here));
  for (std::size_t size = 0; size < 60; ++size)
    EXPECT_NE(cookies.look(0, here, std::span(hello).first(size)).verdict, Verdict::validated) << size;
  constexpr std::size_t kCookie = 13 + 12 + 2 + 32 + 1 + 1;
  for (std::size_t bit = 0; bit < 128; ++bit) {
    Bytes changed = hello;
    changed[kCookie + bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    EXPECT_EQ(cookies.look(0, here, changed).verdict, Verdict::unvalidated) << bit;
  }
}

// ==== seal key ====

const std::string kSecret(64, 'a');
const std::string kGood = "tactus key 1\nname lab\nsecret " + kSecret + "\n";

class SealKey : public ::testing::Test {
 protected:
  SealKey() {
    std::string pattern = (std::filesystem::temp_directory_path() / "tactus-key-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~SealKey() override { std::filesystem::remove_all(folder_); }
  std::string path(const std::string& name = "lab.key") const { return folder_ + "/" + name; }
  std::string written(const std::string& text, mode_t mode) const {
    std::ofstream(path()) << text;
    chmod(path().c_str(), mode);
    return path();
  }

 private:
  std::string folder_;
};

std::string text_of(const std::string& path) {
  std::ostringstream out;
  out << std::ifstream(path).rdbuf();
  return out.str();
}

TEST_F(SealKey, IsWrittenAndReadBack) {
  const mode_t before = umask(0);
  const Key key = Key::generate("room-2.b_C").value();
  ASSERT_TRUE(key.write(path()));
  umask(before);
  struct stat status {};
  ASSERT_EQ(stat(path().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777u, 0600u);
  const auto back = Key::read(path());
  ASSERT_TRUE(back) << to_string(back.error());
  EXPECT_EQ(back->name(), "room-2.b_C");
  EXPECT_TRUE(std::ranges::equal(back->secret(), key.secret()));
  EXPECT_FALSE(std::ranges::equal(back->secret(), Key::generate("lab").value().secret()));
  EXPECT_TRUE(text_of(path()).starts_with("tactus key 1\nname room-2.b_C\nsecret "));
}

TEST_F(SealKey, WhatIsThereStays) {
  written("mine", 0600);
  const auto refused = Key::generate("lab")->write(path());
  ASSERT_FALSE(refused);
  EXPECT_EQ(errno, EEXIST);
  EXPECT_STREQ(refused.error().rule, "R-KEY-1");
  EXPECT_EQ(text_of(path()), "mine");
  std::filesystem::create_symlink(path("nowhere"), path("link"));
  EXPECT_FALSE(Key::generate("lab")->write(path("link")));
  EXPECT_FALSE(std::filesystem::exists(path("nowhere"))) << "links are not followed";
}

TEST_F(SealKey, OthersMayNeitherReadNorWriteIt) {
  for (const mode_t mode : {0640u, 0604u, 0620u, 0602u, 0610u, 0777u}) {
    const auto read = Key::read(written(kGood, mode));
    ASSERT_FALSE(read) << std::oct << mode;
    EXPECT_STREQ(read.error().error.rule, "R-KEY-2");
    EXPECT_EQ(read.error().file, path());
  }
  for (const mode_t mode : {0600u, 0400u}) EXPECT_TRUE(Key::read(written(kGood, mode))) << std::oct << mode;
}

TEST_F(SealKey, OnlyPlainFilesAreRead) {
  EXPECT_STREQ(Key::read(path("nowhere")).error().error.rule, "R-KEY-1");
  std::filesystem::create_directory(path("folder"));
  EXPECT_STREQ(Key::read(path("folder")).error().error.rule, "R-KEY-2");
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_STREQ(Key::read(path("pipe")).error().error.rule, "R-KEY-2") << "and does not wait for a writer";
}

struct Wrong {
  std::string text;
  std::uint64_t line;
};

TEST_F(SealKey, ItsTextHasOneFormOnly) {
  const Wrong wrongs[]{
      {"", 1},
      {"tactus key 2\nname lab\nsecret " + kSecret + "\n", 1},
      {"\xEF\xBB\xBF" + kGood, 1},
      {"tactus key 1\r\nname lab\r\nsecret " + kSecret + "\r\n", 1},
      {"tactus key 1\n\nname lab\nsecret " + kSecret + "\n", 2},
      {"tactus key 1\nname \nsecret " + kSecret + "\n", 2},
      {"tactus key 1\nname a b\nsecret " + kSecret + "\n", 2},
      {"tactus key 1\nname lab \nsecret " + kSecret + "\n", 2},
      {"tactus key 1\nname " + std::string(65, 'n') + "\nsecret " + kSecret + "\n", 2},
      {"tactus key 1\nname l\xC3\xA4\nsecret " + kSecret + "\n", 2},
      {"tactus key 1\nname lab", 2},
      {"tactus key 1\nname lab\n", 3},
      {"tactus key 1\nname lab\nsecret " + kSecret.substr(1) + "\n", 3},
      {"tactus key 1\nname lab\nsecret " + kSecret + "a\n", 3},
      {"tactus key 1\nname lab\nsecret " + std::string(64, 'A') + "\n", 3},
      {"tactus key 1\nname lab\nsecret " + std::string(64, 'g') + "\n", 3},
      {"tactus key 1\nname lab\nsecret " + kSecret, 3},
      {"tactus key 1\nname lab\nsecret  " + kSecret + "\n", 3},
      {kGood + "\n", 4},
      {kGood + "# more\n", 4},
      {kGood + std::string(100'000, 'x'), 4},
      {std::string(100'000, '\0'), 1},
  };
  ASSERT_TRUE(Key::parse(kGood, "f"));
  EXPECT_TRUE(Key::parse("tactus key 1\nname " + std::string(64, 'n') + "\nsecret " + kSecret + "\n", "f"));
  for (const auto& [text, line] : wrongs) {
    const auto read = Key::read(written(text, 0600));
    ASSERT_FALSE(read) << text;
    EXPECT_STREQ(read.error().error.rule, "R-KEY-3");
    EXPECT_EQ(read.error().line, line) << text.substr(0, 100);
    EXPECT_EQ(to_string(read.error()).find("aaaa"), std::string::npos) << "a message never holds the secret";
  }
}

TEST_F(SealKey, NamesAreRefused) {
  for (const std::string& name :
       {std::string(), std::string(65, 'n'), std::string("a b"), std::string("a\n"), std::string("a\0b", 3)}) {
    const auto key = Key::generate(name);
    ASSERT_FALSE(key) << name;
    EXPECT_STREQ(key.error().rule, "R-KEY-4");
  }
}

TEST_F(SealKey, AMovedKeyIsWiped) {
  Key key = Key::generate("lab").value();
  const Key taken = std::move(key);
  EXPECT_EQ(taken.name(), "lab");
  // NOLINTNEXTLINE(bugprone-use-after-move): what is left of it is the point
  EXPECT_TRUE(std::ranges::all_of(key.secret(), [](std::uint8_t byte) { return byte == 0; }));
  alignas(Key) std::byte memory[sizeof(Key)];
  Key* gone = new (memory) Key(Key::generate("lab").value());
  gone->~Key();
  EXPECT_TRUE(std::ranges::all_of(memory, [](std::byte byte) { return byte == std::byte{0}; }));
}

}  // namespace
}  // namespace tactus::seal
