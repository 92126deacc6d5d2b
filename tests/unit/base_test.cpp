// SPDX-License-Identifier: Apache-2.0
/// What all stands on: bytes, fixed point, results, text.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/base/diagnostic.h>
#include <tactus/base/fixed.h>
#include <tactus/base/result.h>
#include <tactus/base/shown.h>
#include <tactus/base/text.h>

namespace tactus {
namespace {

using namespace std::string_literals;

// ==== bytes ====

using Bytes = std::vector<std::uint8_t>;

TEST(Bytes, IntegersAreLittleEndian) {
  Bytes out;
  ByteWriter w(out);
  w.u8(1);
  w.u16(0x0302);
  w.u32(0x07060504);
  w.u64(0x0f0e0d0c0b0a0908);
  w.i32(-2);
  for (std::uint8_t i = 0; i < 15; ++i) EXPECT_EQ(out[i], i + 1);
  ByteReader r(out);
  EXPECT_EQ(r.u8(), 1);
  EXPECT_EQ(r.u16(), 0x0302);
  EXPECT_EQ(r.u32(), 0x07060504u);
  EXPECT_EQ(r.u64(), 0x0f0e0d0c0b0a0908u);
  EXPECT_EQ(r.i32(), -2);
  EXPECT_TRUE(r.ok());
  EXPECT_EQ(r.remaining(), 0u);
}

TEST(Bytes, OverrunSticksAndReadsZero) {
  const Bytes in{1, 2, 3};
  ByteReader r(in);
  EXPECT_EQ(r.u32(), 0u);
  EXPECT_TRUE(r.overrun());
  EXPECT_EQ(r.u8(), 0u) << "a reader that overran must not recover";
  EXPECT_TRUE(r.bytes(1).empty());
}

TEST(Bytes, HugeCountOverrunsWithoutArithmeticOverflow) {
  const Bytes in{1, 2, 3};
  ByteReader r(in);
  r.u8();
  EXPECT_TRUE(r.bytes(std::numeric_limits<std::uint64_t>::max()).empty());
  EXPECT_TRUE(r.overrun());
}

TEST(Bytes, VarintsRoundTripAtEveryWidth) {
  for (int bits = 0; bits <= 64; ++bits) {
    const std::uint64_t top = bits == 0 ? 0 : std::uint64_t{1} << (bits - 1);
    for (const std::uint64_t value : {top, top | (top >> 1), top == 0 ? 0 : (top - 1) | top}) {
      Bytes out;
      ByteWriter(out).varint(value);
      ByteReader r(out);
      EXPECT_EQ(r.varint(), value);
      EXPECT_TRUE(r.ok());
      EXPECT_EQ(r.remaining(), 0u);
    }
  }
}

TEST(Bytes, OverlongVarintsAreRefused) {
  const Bytes cases[] = {
      {0x80, 0x00},                                                        // 0 in two bytes
      {0xff, 0x80, 0x00},                                                  // 127 in three
      {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x02},        // 65 bits
      {0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x01},  // eleven bytes
  };
  for (const Bytes& in : cases) {
    ByteReader r(in);
    r.varint();
    EXPECT_TRUE(r.overlong());
  }
}

TEST(Bytes, SubReaderKeepsItsLimitAndItsPosition) {
  const Bytes in{1, 2, 3, 4, 5};
  ByteReader r(in);
  r.u8();
  ByteReader inner = r.sub(2);
  EXPECT_EQ(inner.bit_offset(), 8u);
  EXPECT_EQ(inner.u16(), 0x0302);
  EXPECT_EQ(inner.u8(), 0);
  EXPECT_TRUE(inner.overrun());
  EXPECT_EQ(r.u8(), 4);
}

TEST(Hash, CheckValues) {
  const std::string_view text = "123456789";
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  EXPECT_EQ(crc32(bytes), 0xcbf43926u);
  EXPECT_EQ(crc32(bytes.subspan(4), crc32(bytes.first(4))), 0xcbf43926u);
  Fnv1a empty;
  EXPECT_EQ(empty.value(), 0xcbf29ce484222325u);
  Fnv1a a;
  a.add_byte('a');
  EXPECT_EQ(a.value(), 0xaf63dc4c8601ec8cu);
}

// ==== fixed ====

double turns(std::uint32_t t) { return t / 4294967296.0 * 2 * std::numbers::pi; }

TEST(Fixed, RoundingGoesHalfUpForBothSigns) {
  EXPECT_EQ(round_shift(5, 1), 3);
  EXPECT_EQ(round_shift(-5, 1), -2);
  EXPECT_EQ(round_shift(-6, 2), -1);
  EXPECT_EQ(round_shift(7, 0), 7);
  EXPECT_EQ(round_div(7, 2), 4);
  EXPECT_EQ(round_div(-7, 2), -3);
  EXPECT_EQ(round_div(-8, 3), -3);
  for (std::int64_t a = -50; a <= 50; ++a) {
    for (std::int64_t b = 1; b <= 9; ++b) {
      EXPECT_EQ(round_div(a, b), static_cast<std::int64_t>(
                                     std::floor((static_cast<double>(a) + static_cast<double>(b / 2)) / static_cast<double>(b))));
    }
  }
}

TEST(Fixed, SaturatesAtBothEnds) {
  EXPECT_EQ(saturate32(std::int64_t{1} << 40), 2147483647);
  EXPECT_EQ(saturate32(-(std::int64_t{1} << 40)), -2147483648LL);
  EXPECT_EQ(saturate32(-5), -5);
}

TEST(Fixed, SquareRootIsTheFloor) {
  std::mt19937_64 random(1);
  const auto check = [](std::uint64_t v) {
    const std::uint64_t r = isqrt(v);
    EXPECT_LE(r * r, v);
    if (r < 0xffffffffu) {
      EXPECT_GT((r + 1) * (r + 1), v);
    }
  };
  for (std::uint64_t v = 0; v < 1000; ++v) check(v);
  for (int i = 0; i < 20000; ++i) check(random() >> (random() % 64));
  for (std::uint64_t r : {65535ull, 65536ull, 0xfffffffeull, 0xffffffffull}) {
    check(r * r);
    check(r * r - 1);
  }
  check(~std::uint64_t{0});
}

TEST(Fixed, SineIsWithinItsStatedError) {
  EXPECT_EQ(sin30(0), 0);
  EXPECT_EQ(sin30(1u << 30), kOne30);
  EXPECT_EQ(sin30(3u << 30), -kOne30);
  EXPECT_EQ(cos30(0), kOne30);
  double worst = 0;
  std::mt19937 random(2);
  for (int i = 0; i < 200000; ++i) {
    const auto t = static_cast<std::uint32_t>(random());
    worst = std::max(worst, std::abs(sin30(t) - std::sin(turns(t)) * kOne30));
  }
  EXPECT_LT(worst, 2.5);
}

TEST(Fixed, ArcSineInvertsTheSine) {
  EXPECT_EQ(asin30(0), 0u);
  std::vector<std::int32_t> sines{759250125, kOne30 - 1, kOne30};
  for (std::int32_t s = 1; s < kOne30 / 2; s += 1 + s / 1000) sines.push_back(s);
  for (std::int32_t s = kOne30 / 4 - 1000; s < kOne30 / 4 + 1000; ++s) sines.push_back(s);  // below, it is found by a series
  for (const std::int32_t s : sines) {
    const std::uint32_t t = asin30(s);
    EXPECT_GE(sin30(t), s);
    if (t > 0) {
      EXPECT_LT(sin30(t - 1), s);
    }
  }
}

TEST(Fixed, ProductsOfTurnsStayUnitLengthAndCompose) {
  Quat30 q{kOne30, 0, 0, 0};
  const Vec3i z{0, 0, kOne30};
  const std::uint32_t step = (1u << 31) / 1000;  // half of 2 pi / 1000
  for (int i = 0; i < 1000; ++i) q = renormalise(multiply(axis_turn(z, step), q));
  std::int64_t square = 0;
  for (const std::int32_t c : q) square += static_cast<std::int64_t>(c) * c;
  EXPECT_NEAR(std::sqrt(static_cast<double>(square)), kOne30, 2.0);
  EXPECT_NEAR(q[0], -kOne30, 4000) << "a full turn changes the sign of the quaternion";
  EXPECT_NEAR(q[3], 0, 4000);
}

TEST(Fixed, ProductMatchesTheDefinitionInFloatingPoint) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto unit = [&] {
    double c[4], n = 0;
    for (double& v : c) {
      v = normal(random);
      n += v * v;
    }
    Quat30 q{};
    for (std::size_t i = 0; i < 4; ++i) q[i] = static_cast<std::int32_t>(std::floor(c[i] / std::sqrt(n) * kOne30));
    return q;
  };
  for (int i = 0; i < 1000; ++i) {
    const Quat30 a = unit(), b = unit(), p = multiply(a, b);
    const auto f = [](std::int32_t v) { return static_cast<double>(v) / kOne30; };
    EXPECT_NEAR(f(p[0]), f(a[0]) * f(b[0]) - f(a[1]) * f(b[1]) - f(a[2]) * f(b[2]) - f(a[3]) * f(b[3]), 1e-9);
    EXPECT_NEAR(f(p[1]), f(a[0]) * f(b[1]) + f(a[1]) * f(b[0]) + f(a[2]) * f(b[3]) - f(a[3]) * f(b[2]), 1e-9);
    const Quat30 one = multiply(a, conjugate(a));
    EXPECT_NEAR(one[0], kOne30, 8);
    EXPECT_NEAR(one[1], 0, 8);
  }
}

// ==== result ====

TEST(Result, EveryErrorClassHasANameOfItsOwn) {
  std::set<std::string> names;
  for (const int value : {2, 3, 4, 5, 6, 7, 8, 10, 11, 12}) names.insert(errc_name(static_cast<Errc>(value)));
  EXPECT_EQ(names.size(), 10u);
  for (const int withdrawn : {1, 9}) EXPECT_STREQ(errc_name(static_cast<Errc>(withdrawn)), "unknown");
  EXPECT_TRUE(names.contains("malformed") && names.contains("limit_exceeded"));
}

TEST(Result, AdviceFollowsFromClassAndRule) {
  EXPECT_EQ(advice({Errc::malformed, "R-RIG-1"}), Advice::drop);
  EXPECT_EQ(advice({Errc::state, "R-PKT-4"}), Advice::request_key);
  EXPECT_EQ(advice({Errc::state, "R-PKT-5"}), Advice::drop);
  EXPECT_EQ(advice({Errc::unsupported, "R-DEF-2"}), Advice::close);
  EXPECT_EQ(advice({Errc::limit_exceeded, "R-PKT-1"}), Advice::drop);
  EXPECT_EQ(advice({Errc::limit_exceeded, "R-DEF-4"}), Advice::close);
}

// ==== diagnostic ====

TEST(Diagnostic, IsLocationRuleFaultAndRemedy) {
  const Error error{Errc::invalid, "R-SRF-11", 0};
  const std::string expected =
      "R-SRF-11: an edge belongs to a third triangle; remove the surplus element or take the mesh apart there";
  EXPECT_EQ(to_string(Diagnostic{error}), expected);
  EXPECT_EQ(location_of(Diagnostic{error}), "");
  const Diagnostic full{
      .error = error, .file = "m.obj", .line = 3, .step = 0, .kind = "triangle", .element = 17, .detail = "'x'"};
  EXPECT_EQ(to_string(full), "m.obj:3: step 0: triangle 17: 'x': " + expected);
  EXPECT_EQ(location_of(full), "line 3, step 0, triangle 17, 'x'");
}

TEST(Diagnostic, FileThatTheSystemNamesTooStandsOnce) {
  const Diagnostic missing{.error = {Errc::invalid, "R-SRF-11", 0}, .file = "libHD.so", .detail = "libHD.so: cannot open"};
  EXPECT_TRUE(to_string(missing).starts_with("libHD.so: cannot open: R-SRF-11: ")) << to_string(missing);
}

TEST(Diagnostic, ItsOwnRemedyGoesBeforeThatOfTheRule) {
  const Error error{Errc::invalid, "R-SRF-11", 0};
  EXPECT_EQ(to_string(Diagnostic{.error = error, .remedy = "Look at it."}),
            "R-SRF-11: an edge belongs to a third triangle; look at it");
  EXPECT_EQ(to_string(Diagnostic{{Errc::invalid, "R-XYZ-1", 0}}), "R-XYZ-1: it breaks a rule that this version does not know");
}

TEST(Diagnostic, WhatComesFromAFileHasNoPower) {
  const Diagnostic evil{.error = {Errc::invalid, "R-SCN-3", 0}, .file = "\x1b[2J", .detail = "a\nb", .remedy = "c\rd"};
  EXPECT_EQ(to_string(evil), "\\x1b[2J: a\\x0ab: R-SCN-3: the key is not known here; c\\x0dd");
}

// ==== shown ====

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

// ==== text ====

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
