// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/shown.h>

#include <gtest/gtest.h>

namespace tactus {
namespace {

using namespace std::string_literals;

TEST(Shown, PlainTextStays) {
  for (const char* text : {"", "cube", "a b\\c\"'`$(x)", "Würfel", "力", "\U0001F600", "\u00A0"}) EXPECT_EQ(shown(text), text);
}

TEST(Shown, ControlCharactersStandAsBytes) {
  EXPECT_EQ(shown("a\x1b[2Jb\rc\nd\te\x7f"s), R"(a\x1b[2Jb\x0dc\x0ad\x09e\x7f)");
  EXPECT_EQ(shown("a\0b"s), R"(a\x00b)");
  EXPECT_EQ(shown("\u009b1m"), R"(\xc2\x9b1m)");
  EXPECT_EQ(shown("\u0080\u009f\u00a0"), "\\xc2\\x80\\xc2\\x9f\u00a0");
}

TEST(Shown, DirectionsAndSeparatorsStandAsBytes) {
  EXPECT_EQ(shown("a\u202Eb"), R"(a\xe2\x80\xaeb)");
  for (const char* c : {"\u061C", "\u200E", "\u200F", "\u2028", "\u2029", "\u202A", "\u202B", "\u202C", "\u202D", "\u202E",
                        "\u2066", "\u2067", "\u2068", "\u2069", "\uFFFE", "\uFFFF"})
    EXPECT_EQ(shown(c).substr(0, 2), "\\x") << shown(c);
  for (const char* c : {"\u061B", "\u200D", "\u2027", "\u202F", "\u2065", "\u206A"}) EXPECT_EQ(shown(c), c);
}

TEST(Shown, BytesThatAreNotUtf8StandAsBytes) {
  EXPECT_EQ(shown("b\xff.mcap"), R"(b\xff.mcap)");
  EXPECT_EQ(shown("\xc3"), R"(\xc3)") << "cut off";
  EXPECT_EQ(shown("\xc0\xaf"), R"(\xc0\xaf)") << "not the shortest form";
  EXPECT_EQ(shown("\xed\xa0\x80"), R"(\xed\xa0\x80)") << "a surrogate";
  EXPECT_EQ(shown("\xf4\x90\x80\x80"), R"(\xf4\x90\x80\x80)") << "above U+10FFFF";
}

TEST(Shown, LongTextIsCut) {
  EXPECT_EQ(shown(std::string(60, 'x')), std::string(60, 'x'));
  EXPECT_EQ(shown(std::string(61, 'x')), std::string(57, 'x') + "...");
  EXPECT_EQ(shown(std::string(std::size_t{1} << 20, '\x1b')).size(), 14 * 4 + 3U);
  std::string umlauts;
  for (int i = 0; i < 60; ++i) umlauts += "ü";
  EXPECT_EQ(shown(umlauts), umlauts) << "characters count, not bytes";
  EXPECT_EQ(shown("abcdef", 5), "ab...");
}

TEST(Shown, OfALongPathTheEndStays) {
  const std::string path = "/" + std::string(5000, 'a') + "/o\x1b.tct";
  EXPECT_EQ(shown_path("/tmp/o.tct"), "/tmp/o.tct");
  EXPECT_EQ(shown_path(path).substr(0, 4), "...a");
  EXPECT_TRUE(shown_path(path).ends_with("/o\\x1b.tct"));
  EXPECT_LE(shown_path(path).size(), 300U);
}

}  // namespace
}  // namespace tactus
