// SPDX-License-Identifier: Apache-2.0
#include <tactus/seal/key.h>

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

namespace tactus::seal {
namespace {

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
  alignas(Key) std::byte place[sizeof(Key)];
  Key* gone = new (place) Key(Key::generate("lab").value());
  gone->~Key();
  EXPECT_TRUE(std::ranges::all_of(place, [](std::byte byte) { return byte == std::byte{0}; }));
}

}  // namespace
}  // namespace tactus::seal
