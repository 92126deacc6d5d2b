// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/text.h>

#include <gtest/gtest.h>

#include <string>

namespace tactus {
namespace {

using namespace std::string_literals;

/// In pieces of every length: what comes out does not depend on where a read ended.
std::string decoded(const std::string& bytes) {
  const std::string whole = decode_text(bytes);
  for (std::size_t piece = 1; piece < 7; ++piece) {
    TextDecoder decoder;
    std::string text;
    for (std::size_t at = 0; at < bytes.size(); at += piece) decoder.add(std::string_view(bytes).substr(at, piece), text);
    decoder.end(text);
    EXPECT_EQ(text, whole) << "in pieces of " << piece;
  }
  return whole;
}

TEST(TextDecoder, PlainTextStaysAsItIs) {
  EXPECT_EQ(decoded(""), "");
  EXPECT_EQ(decoded("a"), "a");
  EXPECT_EQ(decoded("x,y\n1,2\n"), "x,y\n1,2\n");
  EXPECT_EQ(decoded("\xC3\xA9 \xE2\x82\xAC \xF0\x9F\x98\x80"), "\xC3\xA9 \xE2\x82\xAC \xF0\x9F\x98\x80");
  EXPECT_EQ(decoded("a\0b"s), "a\0b"s);
}

TEST(TextDecoder, EndsOfLinesOfEverySystem) {
  EXPECT_EQ(decoded("a\r\nb\rc\nd\r\r\n\n"), "a\nb\nc\nd\n\n\n");
  EXPECT_EQ(decoded("\r"), "\n");
}

TEST(TextDecoder, ByteOrderMarksGo) {
  EXPECT_EQ(decoded("\xEF\xBB\xBFv 0 0 0"), "v 0 0 0");
  EXPECT_EQ(decoded("\xEF\xBB\xBF"), "");
  EXPECT_EQ(decoded("a\xEF\xBB\xBF"), "a\xEF\xBB\xBF");  // only at the front
}

TEST(TextDecoder, Utf16OfBothOrdersWithAndWithoutMark) {
  EXPECT_EQ(decoded("\xFF\xFEt\0,\0\xE9\0\r\0\n\0\x3D\xD8\x00\xDE"s), "t,\xC3\xA9\n\xF0\x9F\x98\x80");
  EXPECT_EQ(decoded("\xFE\xFF\0t\0,\0\xE9\0\r\0\n\xD8\x3D\xDE\x00"s), "t,\xC3\xA9\n\xF0\x9F\x98\x80");
  EXPECT_EQ(decoded("t\0,\0x\0"s), "t,x");
  EXPECT_EQ(decoded("\0t\0,\0x"s), "t,x");
}

TEST(TextDecoder, HalvesOfPairsAreReplaced) {
  EXPECT_EQ(decoded("\xFF\xFE\x00\xDEx\0"s), "\xEF\xBF\xBDx");  // the second half alone
  EXPECT_EQ(decoded("\xFF\xFE\x3D\xD8x\0"s), "\xEF\xBF\xBDx");  // the first
  EXPECT_EQ(decoded("\xFF\xFEx\0\x3D\xD8"s), "x\xEF\xBF\xBD");
  TextDecoder decoder;
  std::string text;
  decoder.add("\xFF\xFEx\0y"s, text);
  EXPECT_FALSE(decoder.end(text));
  EXPECT_EQ(text, "x\xEF\xBF\xBD");
}

TEST(ParseNumber, SpellingsOfOtherPrograms) {
  EXPECT_EQ(parse_number<double>("+0.1"), 0.1);
  EXPECT_EQ(parse_number<double>("-1.5D+02"), -150.0);
  EXPECT_EQ(parse_number<double>("2d-1"), 0.2);
  EXPECT_EQ(parse_number<int>("+7"), 7);
  for (const char* text : {"", "+", "+-1", "++1", "1D", "D1", "0x10", "1,5", "1 ", " 1", "1e5x"}) {
    EXPECT_FALSE(parse_number<double>(text)) << '\'' << text << '\'';
  }
  EXPECT_FALSE(parse_number<int>("1d2"));
  EXPECT_FALSE(parse_number<std::uint8_t>("256"));
}

TEST(PlainName, FitForATopicAndAColumn) {
  EXPECT_TRUE(is_plain_name("cube 1"));
  EXPECT_TRUE(is_plain_name("W\xC3\xBCrfel"));
  for (const std::string& name : {""s, "a/b"s, "a\nb"s, "\x7F"s, "\xC3"s, std::string(256, 'a')})
    EXPECT_FALSE(is_plain_name(name));
}

}  // namespace
}  // namespace tactus
